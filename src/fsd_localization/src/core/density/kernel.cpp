#include "fsd_localization/density/kernel.hpp"

#include <cmath>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {
namespace {

/// Unnormalised profile at distance d < h, both in cells.
double profileValue(KernelProfile profile, double d, double h) {
  switch (profile) {
    case KernelProfile::kUniform:
      return 1.0;
    case KernelProfile::kGaussian:
      return std::exp(-0.5 * d * d / (h * h));
    case KernelProfile::kInverted:
      break;
  }
  // Eq. 2.16 with c = 1 and b = 0.871 c: a disc less an oblate ellipsoid, heaviest at the border.
  constexpr double kB = 0.871;
  return h * (kB + 1.0) - std::sqrt(h * h - d * d);
}

int wholeCells(double bandwidth, double resolution) {
  if (!(bandwidth > 0.0) || !(resolution > 0.0)) {
    throw hyselam::ParameterError("bandwidth", bandwidth, "> 0 m on a grid of positive resolution");
  }
  const double cells = std::round(bandwidth / resolution);
  if (!(cells >= 1.0 && cells <= Kernel::kMaxRadius)) {
    throw hyselam::ParameterError("bandwidth [cells]", cells, "between 1 and 127 cells of the map");
  }
  return static_cast<int>(cells);
}

}  // namespace

void describeKernels(hyselam::ParameterVisitor& visit, std::vector<KernelSpec>& kernels) {
  KernelProfile profile = kernels.empty() ? KernelProfile::kUniform : kernels.front().profile;
  visit("kernel", profile,
        {{"uniform", KernelProfile::kUniform},
         {"gaussian", KernelProfile::kGaussian},
         {"inverted", KernelProfile::kInverted}},
        "profile of the density kernels");
  std::vector<double> bandwidths;
  bandwidths.reserve(kernels.size());
  for (const KernelSpec& k : kernels) bandwidths.push_back(k.bandwidth);
  visit("bandwidths", bandwidths, hyselam::Range::above(0.0), 1, "m", "one kernel each, 1 to 8");
  kernels.clear();
  for (const double h : bandwidths) kernels.push_back({profile, h});
}

void checkKernels(const std::vector<KernelSpec>& kernels) {
  if (kernels.empty() || kernels.size() > 8) {
    throw hyselam::ParameterError("kernels (count)", kernels.size(), "1 to 8");
  }
  for (const KernelSpec& k : kernels) {
    if (!(k.bandwidth > 0.0 && std::isfinite(k.bandwidth))) {
      throw hyselam::ParameterError("bandwidth", k.bandwidth, "> 0 m");
    }
  }
}

KernelProfile kernelProfileFromString(const std::string& name) {
  for (auto p : {KernelProfile::kUniform, KernelProfile::kGaussian, KernelProfile::kInverted}) {
    if (name == toString(p)) return p;
  }
  throw hyselam::ParameterError("kernel", name, "one of uniform, gaussian, inverted");
}

const char* toString(KernelProfile profile) {
  switch (profile) {
    case KernelProfile::kUniform:
      return "uniform";
    case KernelProfile::kGaussian:
      return "gaussian";
    case KernelProfile::kInverted:
      break;
  }
  return "inverted";
}

Kernel::Kernel(KernelProfile profile, int radius) : profile_(profile), radius_(radius) {
  if (radius < 1 || radius > kMaxRadius) {
    throw hyselam::ParameterError("kernel radius [cells]", radius, "between 1 and 127");
  }
  const int r2 = radius * radius;
  weight_by_squared_distance_.resize(static_cast<std::size_t>(r2));
  for (int d2 = 0; d2 < r2; ++d2) {
    weight_by_squared_distance_[static_cast<std::size_t>(d2)] =
        profileValue(profile, std::sqrt(static_cast<double>(d2)), radius);
  }
  double sum = 0.0;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (dx * dx + dy * dy < r2) {
        sum += weight_by_squared_distance_[static_cast<std::size_t>(dx * dx + dy * dy)];
        ++cell_count_;
      }
    }
  }
  for (double& w : weight_by_squared_distance_) w /= sum;
}

Kernel::Kernel(const KernelSpec& spec, double resolution)
    : Kernel(spec.profile, wholeCells(spec.bandwidth, resolution)) {}

double Kernel::weight(int dx, int dy) const {
  const int d2 = dx * dx + dy * dy;
  return d2 < radius_ * radius_ ? weight_by_squared_distance_[static_cast<std::size_t>(d2)] : 0.0;
}

}  // namespace fsd_localization

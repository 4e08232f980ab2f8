#include "ngram_slam/signatures/place_features.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/pose2.hpp"

namespace ngram_slam {

using fsd_localization::BitPlane;
using fsd_localization::FreeSpaceGrid;
using fsd_localization::Kernel;
using fsd_localization::KernelProfile;
using hyselam::Cell;

namespace {

constexpr double kFootprint = 0.3;  // [m]

}  // namespace

PlaceFeatureExtractor::PlaceFeatureExtractor(double resolution, int reach)
    : resolution_(resolution), reach_(reach) {
  if (!(resolution > 0.0)) throw hyselam::ParameterError("resolution", resolution, "above 0");
  if (reach < 1 || reach > 4096) throw hyselam::ParameterError("reach", reach, "1 to 4096 cells");
  for (const double bandwidth : PlaceFeatures::kBandwidths) {
    kernels_.emplace_back(Kernel({KernelProfile::kUniform, bandwidth}, resolution));
  }
  const int side = 2 * reach + 1;
  bin_.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), -1);
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double r = std::hypot(x, y) * resolution;
      if (r >= PlaceFeatures::kRange) continue;
      const double turn = (std::atan2(y, x) + hyselam::kPi) / (2.0 * hyselam::kPi);
      const auto sector = std::min(PlaceFeatures::kSectors - 1,
                                   static_cast<std::size_t>(turn * PlaceFeatures::kSectors));
      const auto ring = static_cast<std::size_t>(r / PlaceFeatures::kRange * PlaceFeatures::kRings);
      bin_[static_cast<std::size_t>((y + reach) * side + x + reach)] =
          static_cast<std::int16_t>(sector * PlaceFeatures::kRings + ring);
    }
  }
}

void PlaceFeatureExtractor::extract(FreeSpaceGrid* view, PlaceFeatures* features) const {
  const Cell middle{reach_, reach_};
  const int body = static_cast<int>(kFootprint / resolution_);
  for (int y = -body; y <= body; ++y) {
    for (int x = -body; x <= body; ++x) {
      view->free.set(middle.x + x, middle.y + y, true);
      view->unknown.set(middle.x + x, middle.y + y, false);
    }
  }
  for (std::size_t k = 0; k < kernels_.size(); ++k) {
    features->densities[k] = static_cast<float>(kernels_[k].soft(*view, middle));
  }
  for (std::size_t b = 0; b < PlaceFeatures::kBeams; ++b) {
    const double bearing =
        2.0 * hyselam::kPi * static_cast<double>(b) / static_cast<double>(PlaceFeatures::kBeams);
    const double dx = std::cos(bearing), dy = std::sin(bearing);
    double x = reach_ + 0.5, y = reach_ + 0.5;
    int steps = 0;
    while (steps < reach_ && view->free.get(static_cast<int>(x), static_cast<int>(y))) {
      x += dx;
      y += dy;
      ++steps;
    }
    features->distances[b] = static_cast<float>(steps * resolution_);
  }
  for (auto& column : features->context) column.fill(0);
  const int side = 2 * reach_ + 1;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; x += 64) {
      std::uint64_t surfaces =
          ~(view->free.row<1>(x, y).words[0] | view->unknown.row<1>(x, y).words[0]);
      if (side - x < 64) surfaces &= (std::uint64_t{1} << (side - x)) - 1;
      for (; surfaces != 0; surfaces &= surfaces - 1) {
        const int k = __builtin_ctzll(surfaces);
        const std::int16_t bin = bin_[static_cast<std::size_t>(y * side + x + k)];
        if (bin < 0) continue;
        const auto b = static_cast<std::size_t>(bin);
        ++features->context[b / PlaceFeatures::kRings][b % PlaceFeatures::kRings];
      }
    }
  }
}

}  // namespace ngram_slam

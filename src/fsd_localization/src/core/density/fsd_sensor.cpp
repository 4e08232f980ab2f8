#include "fsd_localization/density/fsd_sensor.hpp"

#include <algorithm>
#include <array>

#include "fsd_localization/density/frontier_count.hpp"
#include "hyselam_common/errors.hpp"

namespace fsd_localization {

namespace {
constexpr int kPatch = 5;  // the gradient and those of the 8 neighbours need 5 x 5 densities
}

void FsdSensorParams::describe(hyselam::ParameterVisitor& visit) {
  describeKernels(visit, kernels);
  visit.group("gradient_", gradient);
  visit("min_frontier_share", min_frontier_share, hyselam::Range::between(0.0, 1.0), "",
        "of the kernel's perimeter, to be a frontier");
  visit.group("local_map_", local_map);
}

void FsdSensorParams::validate() const {
  checkKernels(kernels);
  hyselam::checkParameters(*this);
  local_map.validate();
  for (const KernelSpec& k : kernels) {
    if (!(k.bandwidth + 3.0 * local_map.resolution <= local_map.radius)) {
      throw hyselam::ParameterError("bandwidth", k.bandwidth,
                                    "at least 3 cells smaller than the local map's radius");
    }
  }
}

FsdSensor::FsdSensor(const FsdSensorParams& params)
    : params_((params.validate(), params)), map_(params.local_map) {
  for (const KernelSpec& spec : params_.kernels) {
    kernels_.emplace_back(Kernel(spec, params_.local_map.resolution));
    reach_ = std::max(reach_, kernels_.back().kernel().radius() + kPatch / 2 + 1);
  }
}

void FsdSensor::integrate(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom) {
  map_.update(scan, base_in_odom);
  stamp_ = scan.stamp;
  base_in_odom_ = base_in_odom;
}

void FsdSensor::reset() {
  map_.clear();
  stamp_ = 0.0;
  base_in_odom_ = {};
}

FsdObservation FsdSensor::observe() {
  map_.freeSpace(reach_, space_);
  FsdObservation result;
  result.stamp = stamp_;
  result.base_in_odom = base_in_odom_;
  for (const FreeSpaceDensity& kernel : kernels_) {
    FsdReading reading;
    reading.density = kernel.density(space_, map_.robotCell());
    if (params_.with_gradient && reading.density.hard) {
      if (const auto descent = descentAtRobot(kernel)) {
        reading.descent = hyselam::normalizeAngle(*descent - base_in_odom_.theta);
      }
    }
    if (params_.with_frontiers) {
      reading.frontiers =
          frontierCount(kernel, space_, map_.robotCell(), params_.min_frontier_share);
    }
    result.readings.push_back(reading);
  }
  return result;
}

std::optional<double> FsdSensor::descentAtRobot(const FreeSpaceDensity& kernel) const {
  const hyselam::Cell robot = map_.robotCell();
  std::array<float, kPatch * kPatch> patch{};
  for (int y = 0; y < kPatch; ++y) {
    for (int x = 0; x < kPatch; ++x) {
      const hyselam::Cell c{robot.x + x - kPatch / 2, robot.y + y - kPatch / 2};
      if (map_.isOccupied(map_.value(c))) continue;  // density 0, as on the global map
      const Density d = kernel.density(space_, c);
      if (!d.hard) return std::nullopt;
      patch[static_cast<std::size_t>(y * kPatch + x)] = static_cast<float>(*d.hard);
    }
  }
  return stableDescent(patch.data(), kPatch, params_.local_map.resolution, params_.gradient);
}

}  // namespace fsd_localization

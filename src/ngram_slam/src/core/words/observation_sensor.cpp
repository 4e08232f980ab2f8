#include "ngram_slam/words/observation_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using fsd_localization::FsdSensorParams;
using fsd_localization::Kernel;
using fsd_localization::KernelProfile;
using hyselam::Cell;
using hyselam::Pose2;

namespace {

constexpr double kFreeCellDistance = 0.3;  // [m]
constexpr double kWindowMargin = 1.0;      // of the free space computed around the robot [m]

FsdSensorParams sensorParams(const ObservationSensorParams& p) {
  p.validate();
  FsdSensorParams out;
  out.local_map.resolution = p.resolution;
  out.local_map.usable_range = p.usable_range;
  // What lies around the spot that is looked back at must not have been forgotten.
  out.local_map.radius = std::max(out.local_map.radius, p.bandwidth + p.look_back + 1.0);
  out.kernels = {{KernelProfile::kUniform, p.bandwidth}};
  out.with_gradient = false;
  return out;
}

double inUnitRange(double density) {
  // Sums of a kernel's weights may exceed 1 by their rounding. FsdObservation holds floats: what
  // comes by it shall be the same.
  return std::clamp(static_cast<double>(static_cast<float>(density)), 0.0, 1.0);
}

}  // namespace

void ObservationSensorParams::describe(hyselam::ParameterVisitor& visit) {
  describeObservations(visit);
  describeLookBack(visit);
}

void ObservationSensorParams::describeObservations(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("bandwidth", bandwidth, Range::between(0.2, 50.0), "m", "radius of the uniform kernel");
  visit("step", step, Range::between(0.01, 10.0), "m", "path length between observations");
  visit("resolution", resolution, Range::between(0.01, 1.0), "m/cell",
        "of the local map; with input scan");
  visit("usable_range", usable_range, Range::atLeast(0.0), "m",
        "beams are cut at this range; 0: as the local map is wide; with input scan");
}

void ObservationSensorParams::describeLookBack(hyselam::ParameterVisitor& visit) {
  visit("look_back", look_back, hyselam::Range::between(0.0, 20.0), "m",
        "driven before the density of a spot is computed again, for word_density full; with input "
        "scan");
}

void ObservationSensorParams::validate() const {
  hyselam::checkParameters(*this);
}

ObservationSensor::ObservationSensor(const ObservationSensorParams& params)
    : params_(params),
      sensor_(sensorParams(params)),
      kernel_(Kernel({KernelProfile::kUniform, params.bandwidth}, params.resolution)),
      sampler_(params.step) {}

std::vector<DensityObservation> ObservationSensor::add(const hyselam::LaserScan& scan,
                                                       const Pose2& base_in_odom) {
  std::vector<DensityObservation> complete;
  std::deque<Pending> held_back;
  // After an odometry jump the map no longer shows the spots that are pending.
  const bool jump = params_.look_back > 0.0 && sampler_.isJump(base_in_odom);
  if (jump) {
    held_back = pending_;
    complete = releaseUpTo(std::numeric_limits<double>::max());
  }
  try {
    sensor_.integrate(scan, base_in_odom);
  } catch (const hyselam::InputError&) {
    if (jump) pending_ = std::move(held_back);
    throw;
  }
  const std::vector<Pose2> due = sampler_.due(base_in_odom);
  if (due.empty()) return complete;
  const fsd_localization::FsdReading reading = sensor_.observe().readings[0];
  DensityObservation now;
  now.stamp = scan.stamp;
  now.base_in_odom = base_in_odom;
  now.soft = inUnitRange(reading.density.soft);
  if (reading.density.hard) now.hard = inUnitRange(*reading.density.hard);
  now.frontiers = std::min(reading.frontiers, 255);
  for (const DensityObservation& o : sampler_.sampleAt(now, due)) {
    path_length_ += params_.step;
    pending_.push_back({o, path_length_});
  }
  const std::vector<DensityObservation> more = releaseUpTo(path_length_ - params_.look_back);
  complete.insert(complete.end(), more.begin(), more.end());
  return complete;
}

std::vector<DensityObservation> ObservationSensor::finish() {
  std::vector<DensityObservation> complete = releaseUpTo(std::numeric_limits<double>::max());
  sensor_.reset();
  sampler_.reset();
  return complete;
}

std::vector<DensityObservation> ObservationSensor::releaseUpTo(double path_length) {
  std::vector<DensityObservation> complete;
  if (pending_.empty() || pending_.front().path_length > path_length) return complete;
  if (params_.look_back > 0.0) {
    const double reach = params_.bandwidth + params_.look_back + kWindowMargin;
    sensor_.localMap().freeSpace(static_cast<int>(std::ceil(reach / params_.resolution)), space_);
  }
  while (!pending_.empty() && pending_.front().path_length <= path_length) {
    DensityObservation o = pending_.front().observation;
    pending_.pop_front();
    if (params_.look_back > 0.0) o.full = fullDensity(o.base_in_odom);
    complete.push_back(o);
  }
  return complete;
}

/// The density of a spot in the map of now. Where the spot is not free in it, of the nearest free
/// cell within kFreeCellDistance.
std::optional<double> ObservationSensor::fullDensity(const Pose2& pose) {
  const fsd_localization::LocalMap& map = sensor_.localMap();
  const Cell spot{static_cast<int>(std::floor(pose.x / params_.resolution)) - map.windowInOdom().x,
                  static_cast<int>(std::floor(pose.y / params_.resolution)) - map.windowInOdom().y};
  const int edge = kernel_.kernel().radius() + 1;
  if (spot.x < edge || spot.y < edge || spot.x >= map.side() - edge ||
      spot.y >= map.side() - edge) {
    return std::nullopt;
  }
  const int reach = static_cast<int>(kFreeCellDistance / params_.resolution);
  std::optional<Cell> nearest;
  int min_squared = reach * reach + 1;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const int d = dx * dx + dy * dy;
      if (d >= min_squared || !space_.free.get(spot.x + dx, spot.y + dy)) continue;
      min_squared = d;
      nearest = Cell{spot.x + dx, spot.y + dy};
    }
  }
  if (!nearest) return std::nullopt;
  return inUnitRange(kernel_.soft(space_, *nearest));
}

}  // namespace ngram_slam

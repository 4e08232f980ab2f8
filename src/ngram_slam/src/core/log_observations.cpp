#include "ngram_slam/log_observations.hpp"

#include <algorithm>

#include "fsd_localization/fsd_sensor.hpp"
#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::Pose2;

LogObservations observationsOf(const hyselam::RobotLog& log, const LogObservationParams& params,
                               const std::function<void(std::size_t)>& progress) {
  fsd_localization::FsdSensorParams sensor_params;
  sensor_params.local_map.resolution = params.resolution;
  sensor_params.local_map.usable_range = params.usable_range;
  sensor_params.kernels = {{fsd_localization::KernelProfile::kUniform, params.bandwidth}};
  sensor_params.with_gradient = false;
  fsd_localization::FsdSensor sensor(sensor_params);
  DistanceSampler sampler(params.step);
  LogObservations out;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (progress) progress(i + 1);
    const hyselam::LaserScan& scan = log.scans[i];
    const auto odom = hyselam::poseAt(log.odometry, scan.stamp, 0.2);
    if (!odom) {
      ++out.scans_without_odometry;
      continue;
    }
    try {
      sensor.integrate(scan, *odom);
    } catch (const hyselam::InputError&) {
      ++out.scans_refused;
      continue;
    }
    const std::vector<Pose2> due = sampler.due(*odom);
    if (due.empty()) continue;
    const fsd_localization::FsdObservation seen = sensor.observe();
    const fsd_localization::Density& density = seen.readings[0].density;
    // Sums of a kernel's weights may exceed 1 by their rounding.
    Observation now;
    now.stamp = scan.stamp;
    now.base_in_odom = *odom;
    now.soft = std::clamp(density.soft, 0.0, 1.0);
    if (density.hard) now.hard = std::clamp(*density.hard, 0.0, 1.0);
    now.frontiers = std::min(seen.readings[0].frontiers, 255);
    const Observation before = out.observations.empty() ? now : out.observations.back();
    const double way = hyselam::distance(before.base_in_odom, *odom);
    const bool jump = way > DistanceSampler::kMaxGap;
    for (const Pose2& pose : due) {
      Observation o = now;
      if (due.size() > 1 && way > 0.0 && !jump) {
        const double share = hyselam::distance(before.base_in_odom, pose) / way;
        o.stamp = before.stamp + share * (now.stamp - before.stamp);
        o.soft = before.soft + share * (now.soft - before.soft);
        o.hard.reset();
      }
      o.base_in_odom = pose;
      out.observations.push_back(o);
    }
  }
  return out;
}

}  // namespace ngram_slam

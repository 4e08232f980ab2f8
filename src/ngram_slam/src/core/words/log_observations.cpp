#include "ngram_slam/words/log_observations.hpp"

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

LogObservations observationsOf(const hyselam::RobotLog& log, const LogObservationParams& params,
                               const std::function<void(std::size_t)>& progress) {
  ObservationSensor sensor(params);
  LogObservations out;
  const auto take = [&](const std::vector<DensityObservation>& more) {
    out.observations.insert(out.observations.end(), more.begin(), more.end());
  };
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (progress) progress(i + 1);
    const hyselam::LaserScan& scan = log.scans[i];
    const auto odom = hyselam::poseAt(log.odometry, scan.stamp, 0.2);
    if (!odom) {
      ++out.scans_without_odometry;
      continue;
    }
    try {
      take(sensor.add(scan, *odom));
    } catch (const hyselam::InputError&) {
      ++out.scans_refused;
    }
  }
  take(sensor.finish());
  return out;
}

}  // namespace ngram_slam

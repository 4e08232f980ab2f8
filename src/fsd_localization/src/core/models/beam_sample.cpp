#include "fsd_localization/models/beam_sample.hpp"

#include <algorithm>
#include <cmath>

namespace fsd_localization {

hyselam::Pose2 laserPose(const Particles& particles, std::size_t i,
                         const hyselam::Pose2& laser_in_base) {
  return particles.pose(i) * hyselam::Pose2{laser_in_base.x, laser_in_base.y, 0.0};
}

void describeMaxRange(hyselam::ParameterVisitor& visit, double& max_range) {
  constexpr double kDefault = -1.0;
  double limit = max_range;
  visit("max_range", limit, hyselam::Range::between(0.1, 1000.0).orValue(kDefault), "m",
        "longer ranges are no returns; -1: the default of the model");
  if (limit != kDefault) max_range = limit;
}

void checkMaxRange(double max_range) {
  if (!(max_range > 0.0)) {
    throw hyselam::ParameterError("max_range", max_range, "in [0.1, 1000] m");
  }
}

BeamSample sampleBeams(const hyselam::LaserScan& scan, int max_beams, double max_range,
                       bool keep_no_return) {
  BeamSample sample;
  sample.laser_in_base = scan.laser_in_base;
  sample.max_range = std::min(max_range, scan.range_max);
  const auto n = static_cast<int>(scan.ranges.size());
  const int count = std::min(n, max_beams);
  for (int k = 0; k < count; ++k) {
    const int i =
        count == 1 ? n / 2
                   : static_cast<int>(std::lround(static_cast<double>(k) * (n - 1) / (count - 1)));
    float r = scan.ranges[static_cast<std::size_t>(i)];
    if (std::isnan(r) || r < scan.range_min) continue;
    if (r >= sample.max_range) {
      if (!keep_no_return) continue;
      r = static_cast<float>(sample.max_range);
    }
    sample.bearing.push_back(
        static_cast<float>(scan.angle_min + i * scan.angle_increment + scan.laser_in_base.theta));
    sample.range.push_back(r);
  }
  return sample;
}

}  // namespace fsd_localization

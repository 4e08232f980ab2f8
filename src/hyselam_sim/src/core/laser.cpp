#include "hyselam_sim/laser.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
void LaserParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("beams", beams, Range::between(2, 100000), "", "of a scan");
  visit("field_of_view", field_of_view, Range::aboveUpTo(0.0, 2.0 * hyselam::kPi), "rad",
        "from the first beam to the last");
  visit("range_min", range_min, Range::atLeast(0.0), "m", "shortest range");
  visit("range_max", range_max, Range::aboveUpTo(0.0, 1e4), "m",
        "longest range; no return reads this");
  visit("resolution", resolution, Range::between(0.0, 1.0), "m",
        "ranges are multiples of this; 0: exact");
  visit("sigma", sigma, Range::between(0.0, 10.0), "m", "standard deviation of a range");
  visit("dropout", dropout, Range::between(0.0, 1.0), "", "probability that a beam has no return");
}

void LaserParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(range_max > range_min)) {
    throw hyselam::ParameterError("range_max", range_max, "above range_min, up to 10000");
  }
}

hyselam::LaserScan takeScan(const LaserParams& params, const PlanRayCaster& world,
                            const std::vector<Disc>& people, const Pose2& base, double stamp,
                            hyselam::Rng& rng) {
  params.validate();
  hyselam::LaserScan scan;
  scan.stamp = stamp;
  scan.angle_min = -0.5 * params.field_of_view;
  scan.angle_increment = params.field_of_view / (params.beams - 1);
  scan.range_min = params.range_min;
  scan.range_max = params.range_max;
  scan.laser_in_base = params.laser_in_base;
  scan.ranges.reserve(static_cast<std::size_t>(params.beams));

  const Pose2 laser = base * params.laser_in_base;
  const Point2 origin{laser.x, laser.y};
  for (int i = 0; i < params.beams; ++i) {
    const double angle = laser.theta + scan.angle_min + i * scan.angle_increment;
    const Point2 direction{std::cos(angle), std::sin(angle)};
    double range = world.cast(origin, direction, params.range_max);
    for (const Disc& person : people) {
      range = std::min(range, hitDistance(origin, direction, person.center, person.radius));
    }
    const double noise = params.sigma * rng.gaussian();
    const bool dropped = rng.uniform() < params.dropout;
    if (dropped || range >= params.range_max) {
      range = params.range_max;
    } else {
      range += noise;
      if (params.resolution > 0.0) {
        range = std::round(range / params.resolution) * params.resolution;
      }
      range = std::clamp(range, params.range_min, params.range_max);
    }
    scan.ranges.push_back(static_cast<float>(range));
  }
  return scan;
}

}  // namespace hyselam_sim

#include "hyselam_sim/laser.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

void check(const LaserParams& p) {
  using hyselam::ParameterError;
  if (p.beams < 2 || p.beams > 100000) throw ParameterError("beams", p.beams, "2 .. 100000");
  if (!(p.field_of_view > 0.0 && p.field_of_view <= 2.0 * hyselam::kPi)) {
    throw ParameterError("field_of_view", p.field_of_view, "within (0, 2 pi]");
  }
  if (!(p.range_min >= 0.0)) throw ParameterError("range_min", p.range_min, ">= 0");
  if (!(p.range_max > p.range_min && p.range_max <= 1e4)) {
    throw ParameterError("range_max", p.range_max, "above range_min, up to 10000");
  }
  if (!(p.resolution >= 0.0 && p.resolution <= 1.0)) {
    throw ParameterError("resolution", p.resolution, "0 .. 1");
  }
  if (!(p.sigma >= 0.0 && p.sigma <= 10.0)) throw ParameterError("sigma", p.sigma, "0 .. 10");
  if (!(p.dropout >= 0.0 && p.dropout <= 1.0)) throw ParameterError("dropout", p.dropout, "0 .. 1");
}

}  // namespace

hyselam::LaserScan takeScan(const LaserParams& params, const RayCaster& world,
                            const std::vector<Disc>& people, const Pose2& base, double stamp,
                            hyselam::Rng& rng) {
  check(params);
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
      range = std::min(range, hitDistance(origin, direction, person.centre, person.radius));
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

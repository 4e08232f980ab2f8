#include "hyselam_scan_matching/surface_points.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

namespace {

using hyselam::Range;

/// The normal of the line through points first..last, towards the origin's side `(sx, sy)`.
void setNormal(const SurfacePoints& all, std::size_t first, std::size_t last, double bend,
               double sx, double sy, SurfacePoint* p) {
  const auto n = static_cast<double>(last - first + 1);
  if (n < 3.0) return;
  double mx = 0.0, my = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    mx += all[i].x;
    my += all[i].y;
  }
  mx /= n;
  my /= n;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    const double dx = all[i].x - mx, dy = all[i].y - my;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double half = 0.5 * (xx + yy), root = std::hypot(0.5 * (xx - yy), xy);
  const double large = half + root, small = std::max(0.0, half - root);
  if (!(large > 0.0) || small > bend * bend * large) return;
  const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
  double nx = -std::sin(along), ny = std::cos(along);
  if (nx * (sx - p->x) + ny * (sy - p->y) < 0.0) {
    nx = -nx;
    ny = -ny;
  }
  p->nx = nx;
  p->ny = ny;
}

/// Whether hypot(x, y) <= reach, which is slow to ask where squares tell.
bool isWithin(double x, double y, double reach) {
  constexpr double kRounding = 1e-12;
  const double squared = x * x + y * y, limit = reach * reach;
  if (squared < limit * (1.0 - kRounding)) return true;
  if (squared > limit * (1.0 + kRounding)) return false;
  return std::hypot(x, y) <= reach;
}

}  // namespace

void SurfacePointParams::describe(hyselam::ParameterVisitor& visit) {
  visit("max_range", max_range, Range::above(0.0), "m", "farther returns are left out");
  visit("min_spacing", min_spacing, Range::atLeast(0.0), "m", "closer points are left out");
  visit("normal_radius", normal_radius, Range::above(0.0), "m",
        "radius of the neighborhood to which a line is fitted for the normal");
  visit("normal_radius_per_meter", normal_radius_per_meter, Range::atLeast(0.0), "m/m",
        "the same per meter of range, where beams are farther apart");
  visit("max_normal_deviation", max_normal_deviation, Range::above(0.0), "",
        "largest deviation of neighbors from the line, as a part of its length");
}

void SurfacePointParams::validate() const {
  hyselam::checkParameters(*this);
}

SurfacePoints surfacePoints(const hyselam::LaserScan& scan, const SurfacePointParams& params) {
  SurfacePoints all;
  std::vector<double> reach;
  all.reserve(scan.ranges.size());
  const double limit = std::min(scan.range_max, params.max_range);
  const hyselam::Pose2& laser = scan.laser_in_base;
  const double c = std::cos(laser.theta), s = std::sin(laser.theta);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto r = static_cast<double>(scan.ranges[i]);
    if (!(r >= scan.range_min && r < limit)) continue;
    const double bearing = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const double x = r * std::cos(bearing), y = r * std::sin(bearing);
    all.push_back({laser.x + c * x - s * y, laser.y + s * x + c * y, 0.0, 0.0});
    reach.push_back(std::max(params.normal_radius, params.normal_radius_per_meter * r));
  }
  SurfacePoints kept;
  kept.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto near = [&](std::size_t j) {
      return isWithin(all[i].x - all[j].x, all[i].y - all[j].y, reach[i]);
    };
    SurfacePoint p = all[i];
    if (!kept.empty() && std::hypot(p.x - kept.back().x, p.y - kept.back().y) < params.min_spacing)
      continue;
    std::size_t first = i, last = i;
    while (first > 0 && near(first - 1)) --first;
    while (last + 1 < all.size() && near(last + 1)) ++last;
    setNormal(all, first, last, params.max_normal_deviation, scan.laser_in_base.x,
              scan.laser_in_base.y, &p);
    kept.push_back(p);
  }
  return kept;
}

SurfacePoints transformed(const hyselam::Pose2& pose, const SurfacePoints& points) {
  const double c = std::cos(pose.theta), s = std::sin(pose.theta);
  SurfacePoints result;
  result.reserve(points.size());
  for (const SurfacePoint& p : points)
    result.push_back({pose.x + c * p.x - s * p.y, pose.y + s * p.x + c * p.y, c * p.nx - s * p.ny,
                      s * p.nx + c * p.ny});
  return result;
}

}  // namespace hyselam_scan_matching

#include "fsd_localization/search/short_term_layer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace fsd_localization {

using hyselam::Point2;
using hyselam::Pose2;

namespace {
constexpr double kPruneStep = 5.0;  // [m] of way between looks at what is old

/// Of two numbers of 32 bits.
std::uint64_t keyOf(std::int32_t x, std::int32_t y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y);
}
/// Of what is farther than any map is large: the last cell but one.
std::int32_t cellOf(double metres) {
  constexpr double kFarthest = std::numeric_limits<std::int32_t>::max() - 1;
  return static_cast<std::int32_t>(
      std::clamp(std::floor(metres / ShortTermLayer::kCell), -kFarthest, kFarthest));
}
bool isReturn(const hyselam::LaserScan& scan, double r, double max_range) {
  return r >= scan.range_min && r < std::min(scan.range_max, max_range);
}
Point2 endOf(const hyselam::LaserScan& scan, const Pose2& laser, double c, double s,
             std::size_t beam) {
  const auto r = static_cast<double>(scan.ranges[beam]);
  const double bearing = scan.angle_min + static_cast<double>(beam) * scan.angle_increment;
  const double x = r * std::cos(bearing), y = r * std::sin(bearing);
  return {laser.x + c * x - s * y, laser.y + s * x + c * y};
}
}  // namespace

std::vector<Point2> ShortTermLayer::endsOf(const hyselam::LaserScan& scan, const Pose2& base,
                                           double max_range) {
  const Pose2 laser = base * scan.laser_in_base;
  const double c = std::cos(laser.theta), s = std::sin(laser.theta);
  std::vector<Point2> ends;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (isReturn(scan, scan.ranges[i], max_range)) ends.push_back(endOf(scan, laser, c, s, i));
  }
  return ends;
}

void ShortTermLayer::add(const std::vector<Point2>& ends, const std::vector<bool>& on_map,
                         double way) {
  for (std::size_t i = 0; i < ends.size(); ++i) {
    Seen& seen = cells_[keyOf(cellOf(ends[i].x), cellOf(ends[i].y))];
    ++(on_map[i] ? seen.on_map : seen.off_map);
    seen.way = way;
  }
  if (way - pruned_at_ < kPruneStep && way >= pruned_at_) return;
  pruned_at_ = way;
  for (auto it = cells_.begin(); it != cells_.end();) {
    it = way - it->second.way > kKept ? cells_.erase(it) : std::next(it);
  }
}

bool ShortTermLayer::isOfThePresent(const Point2& at) const {
  const std::int32_t cx = cellOf(at.x), cy = cellOf(at.y);
  int on_map = 0, off_map = 0;
  for (std::int32_t y = cy - 1; y <= cy + 1; ++y) {
    for (std::int32_t x = cx - 1; x <= cx + 1; ++x) {
      const auto found = cells_.find(keyOf(x, y));
      if (found == cells_.end()) continue;
      on_map += found->second.on_map;
      off_map += found->second.off_map;
    }
  }
  return off_map >= kSeen && off_map > on_map;
}

std::vector<Point2> ShortTermLayer::points() const {
  std::vector<Point2> all;
  for (const auto& [key, seen] : cells_) {
    const auto x = static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32U));
    const auto y = static_cast<std::int32_t>(static_cast<std::uint32_t>(key));
    const Point2 middle{(x + 0.5) * kCell, (y + 0.5) * kCell};
    if (seen.off_map > 0 && isOfThePresent(middle)) all.push_back(middle);
  }
  std::sort(all.begin(), all.end(),
            [](const Point2& a, const Point2& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return all;
}

hyselam::LaserScan ShortTermLayer::without(const hyselam::LaserScan& scan,
                                           const Pose2& base) const {
  hyselam::LaserScan rest = scan;
  if (cells_.empty()) return rest;
  const Pose2 laser = base * scan.laser_in_base;
  const double c = std::cos(laser.theta), s = std::sin(laser.theta);
  for (std::size_t i = 0; i < rest.ranges.size(); ++i) {
    if (!isReturn(scan, scan.ranges[i], std::numeric_limits<double>::infinity())) continue;
    if (isOfThePresent(endOf(scan, laser, c, s, i))) {
      rest.ranges[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return rest;
}

}  // namespace fsd_localization

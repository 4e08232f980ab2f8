#include "ngram_slam/signatures/window_map.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::Point2;
using hyselam::Pose2;

namespace {

// A cell counts as a surface where at least one beam in so many ended.
constexpr int kFreePerHit = 3;
constexpr double kMinBeamAngle = 0.008;  // [rad] finer beams are thinned

int cellOf(double coordinate, double resolution) {
  return static_cast<int>(std::floor(coordinate / resolution));
}

}  // namespace

WindowMap::WindowMap(double resolution, double range, double extent)
    : resolution_(resolution), range_(range), reach_(0), size_(1) {
  if (!(resolution > 0.0)) throw hyselam::ParameterError("resolution", resolution, "above 0");
  if (!(range > 0.0)) throw hyselam::ParameterError("range", range, "above 0");
  if (!(extent > 0.0)) throw hyselam::ParameterError("extent", extent, "above 0");
  const double side = (2.0 * range + extent) / resolution + 2.0;
  if (!(side <= 2048.0)) {
    throw hyselam::ParameterError("resolution", resolution, "at most 2048 cells along a side");
  }
  reach_ = static_cast<int>(std::ceil(range / resolution));
  while (size_ < side) size_ *= 2;
  counts_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_), {});
}

void WindowMap::clear() {
  std::fill(counts_.begin(), counts_.end(), Count{});
}

void WindowMap::trace(const Pose2& base, const hyselam::LaserScan& scan, int sign) {
  const Pose2 laser = base * scan.laser_in_base;
  const auto step = static_cast<std::size_t>(
      std::max(1.0, std::floor(kMinBeamAngle / std::max(1e-9, std::abs(scan.angle_increment)))));
  const unsigned mask = static_cast<unsigned>(size_) - 1U;
  const auto stride = static_cast<unsigned>(size_);
  const auto one = static_cast<std::int32_t>(sign);
  for (std::size_t b = 0; b < scan.ranges.size(); b += step) {
    const double range = scan.ranges[b];
    if (!(range >= scan.range_min)) continue;
    const bool is_return = range < scan.range_max && range < range_;
    const double length = std::min(range, range_) / resolution_;
    const double bearing =
        laser.theta + scan.angle_min + static_cast<double>(b) * scan.angle_increment;
    const double dx = std::cos(bearing), dy = std::sin(bearing);
    // One cell a step along the axis that the beam follows most.
    const double scale = 1.0 / std::max(std::abs(dx), std::abs(dy));
    const int steps = static_cast<int>(length / scale);
    double x = laser.x / resolution_, y = laser.y / resolution_;
    const double sx = dx * scale, sy = dy * scale;
    const auto hit_x = static_cast<int>(std::floor(x + length * dx));
    const auto hit_y = static_cast<int>(std::floor(y + length * dy));
    for (int i = 0; i < steps; ++i, x += sx, y += sy) {
      const auto cx = static_cast<int>(std::floor(x)), cy = static_cast<int>(std::floor(y));
      if (is_return && cx == hit_x && cy == hit_y) break;
      Count& c =
          counts_[(static_cast<unsigned>(cy) & mask) * stride + (static_cast<unsigned>(cx) & mask)];
      c.free = static_cast<std::int32_t>(c.free + one);
    }
    if (!is_return) continue;
    Count& c = counts_[(static_cast<unsigned>(hit_y) & mask) * stride +
                       (static_cast<unsigned>(hit_x) & mask)];
    c.hits = static_cast<std::int32_t>(c.hits + one);
  }
}

fsd_localization::FreeSpaceGrid WindowMap::emptyView() const {
  return {2 * reach_ + 1, 2 * reach_ + 1};
}

void WindowMap::view(const Point2& middle, fsd_localization::FreeSpaceGrid* view) const {
  const int x0 = cellOf(middle.x, resolution_) - reach_,
            y0 = cellOf(middle.y, resolution_) - reach_;
  const int side = 2 * reach_ + 1;
  const unsigned mask = static_cast<unsigned>(size_) - 1U;
  for (int y = 0; y < side; ++y) {
    const Count* row =
        counts_.data() + (static_cast<unsigned>(y0 + y) & mask) * static_cast<std::size_t>(size_);
    for (int x = 0; x < side; x += 64) {
      std::uint64_t free = 0, unknown = 0;
      const int n = std::min(64, side - x);
      for (int k = 0; k < n; ++k) {
        const Count c = row[static_cast<unsigned>(x0 + x + k) & mask];
        const bool seen = c.free > 0 || c.hits > 0;
        unknown |= static_cast<std::uint64_t>(!seen) << k;
        free |= static_cast<std::uint64_t>(seen && c.free > kFreePerHit * c.hits) << k;
      }
      view->free.setWord(x, y, free);
      view->unknown.setWord(x, y, unknown);
    }
  }
}

}  // namespace ngram_slam

#include "fsd_localization/density/local_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::Cell;
using hyselam::kPi;
using hyselam::LaserScan;
using hyselam::ParameterError;
using hyselam::Pose2;

namespace {

void checkScan(const LaserScan& scan, const Pose2& base_in_odom) {
  const auto refuse = [](const std::string& place, const std::string& why) {
    throw hyselam::InputError("laser scan", place, why);
  };
  if (!base_in_odom.isFinite()) refuse("pose in odom", "not finite");
  if (!scan.laser_in_base.isFinite()) refuse("pose of the laser on the robot", "not finite");
  if (scan.ranges.empty()) refuse("ranges", "no beams");
  if (!std::isfinite(scan.angle_min)) refuse("angle_min", "not finite");
  if (!std::isfinite(scan.angle_increment) || scan.angle_increment == 0.0) {
    refuse("angle_increment", "must be finite and not 0");
  }
  if (std::abs(scan.angle_increment) * static_cast<double>(scan.ranges.size()) > 4.0 * kPi) {
    refuse("angle_increment", "the beams span more than two turns");
  }
  if (!(scan.range_min >= 0.0) || !(scan.range_max > scan.range_min)) {
    refuse("range_min, range_max", "need 0 <= range_min < range_max");
  }
}

/// The smallest n >= 0 with predicate(sqrt(n)), for a predicate that is false, then true; starting
/// from a guess that is at most a few off. Gives thresholds on squared distances that decide
/// exactly as the comparison of distances in Alg. 2.2 does.
template <typename Predicate>
std::int32_t firstSquare(double guess, std::int32_t limit, Predicate predicate) {
  auto n = static_cast<std::int32_t>(std::min(std::max(guess, 0.0), static_cast<double>(limit)));
  while (n > 0 && predicate(std::sqrt(static_cast<double>(n - 1)))) --n;
  while (n < limit && !predicate(std::sqrt(static_cast<double>(n)))) ++n;
  return n;
}

}  // namespace

void LocalMapParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("radius", radius, Range::between(0.5, 100.0), "m", "surroundings that are remembered");
  visit("resolution", resolution, Range::between(0.01, 1.0), "m", "of a cell");
  visit("usable_range", usable_range, Range::atLeast(0.0), "m",
        "beams are not used beyond it; 0: min(range_max, radius)");
  visit("obstacle_depth", obstacle_depth, Range::aboveUpTo(0.0, 10.0), "cells",
        "an obstacle covers the cells nearer than this to a beam's end");
  visit("free_below", free_below, Range::between(1, LocalMap::kUnknown), "",
        "HIMM value (0..15, 8 is unknown) below which a cell is free");
  visit("occupied_above", occupied_above,
        Range::between(LocalMap::kUnknown, LocalMap::kMaxValue - 1), "",
        "HIMM value above which a cell is occupied");
  visit("footprint_radius", footprint_radius, Range::atLeast(0.0), "m",
        "free around the robot's center; 0: only what the laser sees");
}

void LocalMapParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(radius >= resolution && radius / resolution <= 1000.0)) {
    throw ParameterError("radius", radius, "between 1 and 1000 cells");
  }
  if (!(footprint_radius <= radius)) {
    throw ParameterError("footprint_radius", footprint_radius, "between 0 and radius");
  }
}

LocalMap::LocalMap(const LocalMapParams& params) : params_(params) {
  params_.validate();
  radius_cells_ = static_cast<int>(std::lround(params_.radius / params_.resolution));
  side_ = 2 * radius_cells_ + 1;
  for (int dy = -radius_cells_; dy <= radius_cells_; ++dy) {
    int w = -1;  // the row holds the cells |dx| <= w; none on the outermost rows
    while ((w + 1) * (w + 1) + dy * dy < radius_cells_ * radius_cells_) ++w;
    half_width_.push_back(w);
  }
  layOut(0);
}

void LocalMap::layOut(int pad) {
  const std::vector<std::uint8_t> old = std::move(cells_);
  const int old_pad = pad_, old_stride = stride_;
  pad_ = pad;
  stride_ = side_ + 2 * pad;
  cells_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(stride_), kUnknown);
  if (!old.empty()) {
    for (int y = 0; y < side_; ++y) {
      std::memcpy(&cells_[index({0, y})],
                  &old[static_cast<std::size_t>((y + old_pad) * old_stride + old_pad)],
                  static_cast<std::size_t>(side_));
    }
  }

  // Rings let a short beam leave the far cells alone.
  const int r = radius_cells_;
  rings_.assign(kRings, {});
  constexpr int kCount = kRings;
  for (int i = 0; i < kCount; ++i) {
    const int inner = r * i / kCount, outer = r * (i + 1) / kCount;
    Ring& ring = rings_[static_cast<std::size_t>(i)];
    ring.begin = inner * inner;
    ring.end = outer * outer;
    std::vector<std::pair<double, VisibleCell>> table;
    for (int dy = -outer; dy <= outer; ++dy) {
      for (int dx = -outer; dx <= outer; ++dx) {
        const int d2 = dx * dx + dy * dy;
        if (d2 >= ring.begin && d2 < ring.end) {
          table.push_back({std::atan2(dy, dx), {dy * stride_ + dx, d2}});
        }
      }
    }
    std::stable_sort(table.begin(), table.end(),
                     [](const auto& one, const auto& two) { return one.first < two.first; });
    for (const double turn : {0.0, 2.0 * kPi}) {
      for (const auto& [bearing, cell] : table) {
        ring.bearings.push_back(bearing + turn);
        ring.cells.push_back(cell);
      }
    }
  }
}

void LocalMap::clear() {
  std::fill(cells_.begin(), cells_.end(), kUnknown);
  placed_ = false;
}

void LocalMap::check(const LaserScan& scan, const Pose2& base_in_odom) const {
  checkScan(scan, base_in_odom);
  constexpr double kFarthest = 1e8;  // [cells]: beyond it cell numbers would not fit an int
  if (std::abs(base_in_odom.x) > kFarthest * params_.resolution ||
      std::abs(base_in_odom.y) > kFarthest * params_.resolution) {
    throw hyselam::InputError("laser scan", "pose in odom",
                              "farther than 1e8 cells from the origin");
  }
  const Cell robot = cellOf(base_in_odom), laser = cellOf(base_in_odom * scan.laser_in_base);
  if (std::max(std::abs(laser.x - robot.x), std::abs(laser.y - robot.y)) >= radius_cells_) {
    throw hyselam::InputError("laser scan", "pose of the laser on the robot",
                              "the laser sits outside the local map");
  }
}

void LocalMap::update(const LaserScan& scan, const Pose2& base_in_odom) {
  check(scan, base_in_odom);
  const Pose2 laser_in_odom = base_in_odom * scan.laser_in_base;
  const Cell robot = cellOf(base_in_odom), laser = cellOf(laser_in_odom);
  const int off = std::max(std::abs(laser.x - robot.x), std::abs(laser.y - robot.y));
  if (off > pad_) layOut(off);
  moveTo(robot);
  sweep(scan, laser_in_odom.theta, {laser.x - window_.x, laser.y - window_.y});
  forgetOutside();
  clearFootprint();
}

hyselam::Cell LocalMap::cellOf(const Pose2& p) const {
  return {static_cast<int>(std::floor(p.x / params_.resolution)),
          static_cast<int>(std::floor(p.y / params_.resolution))};
}

void LocalMap::moveTo(Cell robot_in_odom) {
  const Cell corner{robot_in_odom.x - radius_cells_, robot_in_odom.y - radius_cells_};
  if (placed_ && corner == window_) return;
  if (!placed_) {
    window_ = corner;
    placed_ = true;
    return;
  }
  const long dx = static_cast<long>(corner.x) - window_.x,
             dy = static_cast<long>(corner.y) - window_.y;
  scratch_.assign(cells_.size(), kUnknown);
  if (std::abs(dx) < side_ && std::abs(dy) < side_) {
    const int x_from = static_cast<int>(std::max(0L, dx));
    const int count = side_ - static_cast<int>(std::abs(dx));
    for (int y = 0; y < side_; ++y) {
      const int old_y = y + static_cast<int>(dy);
      if (old_y < 0 || old_y >= side_) continue;
      std::memcpy(&scratch_[index({x_from - static_cast<int>(dx), y})],
                  &cells_[index({x_from, old_y})], static_cast<std::size_t>(count));
    }
  }
  cells_.swap(scratch_);
  window_ = corner;
}

void LocalMap::forgetOutside() {
  for (int y = -pad_; y < side_ + pad_; ++y) {
    std::uint8_t* row = &cells_[index({-pad_, y})];
    const int half = y >= 0 && y < side_ ? half_width_[static_cast<std::size_t>(y)] : -1;
    const int left = half < 0 ? stride_ : pad_ + radius_cells_ - half;
    std::memset(row, kUnknown, static_cast<std::size_t>(left));
    if (half >= 0) std::memset(row + left + 2 * half + 1, kUnknown, static_cast<std::size_t>(left));
  }
}

std::optional<LocalMap::BeamLimits> LocalMap::limitsOf(float range, const LaserScan& scan) const {
  const double reach = params_.usable_range > 0.0 ? std::min(params_.usable_range, params_.radius)
                                                  : std::min(scan.range_max, params_.radius);
  if (std::isnan(range) || range < scan.range_min) return std::nullopt;
  const std::int32_t end = radius_cells_ * radius_cells_;  // d_i < d_max
  const double eps = params_.obstacle_depth;
  BeamLimits limits;
  if (range >= scan.range_max || range > reach) {  // free as far as the sensor can be trusted
    const double d = reach / params_.resolution;
    limits.free_end = firstSquare(d * d, end, [&](double d_i) { return !(d_i < d); });
    return limits;
  }
  const double d = static_cast<double>(range) / params_.resolution;
  const double lo = d - eps, hi = d + eps;
  limits.free_end =
      firstSquare(lo > 0 ? lo * lo : 0.0, end, [&](double d_i) { return !(d_i < d - eps); });
  limits.occupied_begin = firstSquare(lo > 0 ? lo * lo : 0.0, end,
                                      [&](double d_i) { return d_i >= d || d - d_i < eps; });
  limits.occupied_end =
      firstSquare(hi * hi, end, [&](double d_i) { return d_i > d && !(d_i - d < eps); });
  limits.free_end = std::min(limits.free_end, limits.occupied_begin);
  return limits;
}

void LocalMap::sweep(const LaserScan& scan, double laser_heading, Cell laser_cell) {
  const double inc = std::abs(scan.angle_increment);
  const bool reversed = scan.angle_increment < 0.0;
  // More beams than a turn holds would see the same cells again.
  const auto beams = std::min(static_cast<long>(scan.ranges.size()),
                              static_cast<long>(std::floor(2.0 * kPi / inc)) + 1);
  const double lowest = reversed
                            ? scan.angle_min + scan.angle_increment * static_cast<double>(beams - 1)
                            : scan.angle_min;
  // Each beam owns the bearings nearest to it: half an increment to either side, less at the ends
  // of a scan that comes full circle.
  const double excess = std::max(0.0, static_cast<double>(beams) * inc - 2.0 * kPi);
  const double start = hyselam::normalizeAngle(lowest - 0.5 * inc + 0.5 * excess + laser_heading);
  const double shift = start - (lowest - 0.5 * inc + 0.5 * excess);
  const double stop = start + static_cast<double>(beams) * inc - excess;

  std::uint8_t* const laser = cells_.data() + index(laser_cell);
  std::array<std::size_t, kRings> cursor{};
  for (std::size_t r = 0; r < kRings; ++r) {
    cursor[r] = static_cast<std::size_t>(
        std::lower_bound(rings_[r].bearings.begin(), rings_[r].bearings.end(), start) -
        rings_[r].bearings.begin());
  }
  for (long j = 0; j < beams; ++j) {
    const double to = std::min(lowest + (static_cast<double>(j) + 0.5) * inc + shift, stop);
    const auto limits =
        limitsOf(scan.ranges[static_cast<std::size_t>(reversed ? beams - 1 - j : j)], scan);
    const std::int32_t reach = limits ? std::max(limits->free_end, limits->occupied_end) : 0;
    for (std::size_t r = 0; r < kRings; ++r) {
      const Ring& ring = rings_[r];
      std::size_t end = cursor[r];
      while (end < ring.bearings.size() && ring.bearings[end] < to) ++end;
      if (limits && ring.begin < reach) updateCells(ring, cursor[r], end, *limits, laser);
      cursor[r] = end;
    }
  }
}

void LocalMap::updateCells(const Ring& ring, std::size_t from, std::size_t to,
                           const BeamLimits& limits, std::uint8_t* laser) {
  const VisibleCell* cell = ring.cells.data() + from;
  const VisibleCell* const last = ring.cells.data() + to;
  if (ring.end <= limits.free_end) {
    for (; cell != last; ++cell) {
      std::uint8_t& value = laser[cell->offset];
      value = static_cast<std::uint8_t>(value - (value != 0 ? kMiss : 0));
    }
    return;
  }
  for (; cell != last; ++cell) {
    const int d2 = cell->squared_distance;
    const int miss = d2 < limits.free_end ? kMiss : 0;
    const int hit = ((d2 >= limits.occupied_begin) & (d2 < limits.occupied_end)) ? kHit : 0;
    std::uint8_t& value = laser[cell->offset];
    value =
        static_cast<std::uint8_t>(std::clamp(value + hit - miss, 0, static_cast<int>(kMaxValue)));
  }
}

void LocalMap::clearFootprint() {
  if (params_.footprint_radius <= 0.0) return;
  const double r = params_.footprint_radius / params_.resolution;
  const int n = static_cast<int>(r);
  for (int dy = -n; dy <= n; ++dy) {
    for (int dx = -n; dx <= n; ++dx) {
      if (dx * dx + dy * dy <= r * r) cells_[index({radius_cells_ + dx, radius_cells_ + dy})] = 0;
    }
  }
}

void LocalMap::freeSpace(int reach, FreeSpaceGrid& out) const {
  if (out.free.width() != side_) out = FreeSpaceGrid(side_, side_);
  const int first = std::max(0, radius_cells_ - reach),
            last = std::min(side_, radius_cells_ + reach + 1);
  // Eight cells at a time: adding 128 - t to a byte below 128 sets its top bit where it is >= t,
  // and the multiplication gathers the eight top bits in one byte.
  constexpr std::uint64_t kOnes = 0x0101010101010101ULL, kTop = 0x8080808080808080ULL;
  const std::uint64_t not_free_from = kOnes * static_cast<std::uint64_t>(128 - params_.free_below);
  const std::uint64_t occupied_from =
      kOnes * static_cast<std::uint64_t>(128 - (params_.occupied_above + 1));
  const auto gather = [](std::uint64_t top_bits) {
    return ((top_bits >> 7) * 0x0102040810204080ULL) >> 56;
  };
  for (int y = first; y < last; ++y) {
    const std::uint8_t* row = &cells_[index({0, y})];
    for (int x0 = first / 64 * 64; x0 < last; x0 += 64) {
      std::uint64_t free = 0, unknown = 0;
      for (int k = 0; k < 64 && x0 + k < side_; k += 8) {
        std::uint64_t eight = kOnes * kMaxValue;
        std::memcpy(&eight, row + x0 + k, static_cast<std::size_t>(std::min(8, side_ - x0 - k)));
        const std::uint64_t not_free = (eight + not_free_from) & kTop;
        const std::uint64_t occupied = (eight + occupied_from) & kTop;
        free |= gather(~not_free & kTop) << k;
        unknown |= gather(not_free & ~occupied) << k;
      }
      out.free.setWord(x0, y, free);
      out.unknown.setWord(x0, y, unknown);
    }
  }
}

hyselam::OccupancyGrid LocalMap::toGrid() const {
  hyselam::GridGeometry g;
  g.width = g.height = side_;
  g.resolution = params_.resolution;
  g.origin = {window_.x * params_.resolution, window_.y * params_.resolution, 0.0};
  hyselam::OccupancyGrid grid(g);
  for (int y = 0; y < side_; ++y) {
    for (int x = 0; x < side_; ++x) {
      const std::uint8_t v = value({x, y});
      if (isFree(v)) {
        grid.at({x, y}) = hyselam::OccupancyGrid::kFree;
      } else if (isOccupied(v)) {
        grid.at({x, y}) = hyselam::OccupancyGrid::kOccupied;
      }
    }
  }
  return grid;
}

}  // namespace fsd_localization

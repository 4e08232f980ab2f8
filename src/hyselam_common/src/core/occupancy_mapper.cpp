#include "hyselam_common/occupancy_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "hyselam_common/errors.hpp"

namespace hyselam {
namespace {

constexpr double kMaxCellCoordinate = 1e8;  // well inside int, also after adding margins

}  // namespace

void OccupancyMapperParams::describe(ParameterVisitor& visit) {
  visit("resolution", resolution, Range::aboveUpTo(0.0, 1000.0), "m/cell", "side of a cell");
  visit("usable_range", usable_range, Range::above(0.0), "m",
        "farther returns clear the beam up to here only");
  visit("no_return_clears", no_return_clears, Range::atLeast(0.0), "m",
        "a beam without return clears cells up to here");
  visit("occupied_ratio", occupied_ratio, Range::inside(0.0, 1.0), "",
        "hits / (hits + misses) above which a cell is occupied");
  visit("min_observations", min_observations, Range::atLeast(1), "",
        "cells observed less often stay unknown");
  visit("max_map_cells", max_cells, Range::atLeast(1), "cells", "growth beyond is refused");
}

void OccupancyMapperParams::validate() const {
  checkParameters(*this);
}

OccupancyMapper::OccupancyMapper(const OccupancyMapperParams& parameters)
    : parameters_(parameters) {
  parameters_.validate();
}

void OccupancyMapper::clear() {
  scans_ = 0;
  box_ = Box{};
  counts_.clear();
}

void OccupancyMapper::cover(const Box& box) {
  const bool empty = counts_.empty();
  if (!empty && box.min_x >= box_.min_x && box.min_y >= box_.min_y && box.max_x <= box_.max_x &&
      box.max_y <= box_.max_y) {
    return;
  }
  // Grown by a quarter on the sides that are too small, so that few scans make it grow.
  Box grown = empty ? box : box_;
  const int slack_x = 64 + (grown.max_x - grown.min_x) / 4;
  const int slack_y = 64 + (grown.max_y - grown.min_y) / 4;
  if (box.min_x < grown.min_x || empty) grown.min_x = box.min_x - slack_x;
  if (box.min_y < grown.min_y || empty) grown.min_y = box.min_y - slack_y;
  if (box.max_x > grown.max_x || empty) grown.max_x = box.max_x + slack_x;
  if (box.max_y > grown.max_y || empty) grown.max_y = box.max_y + slack_y;
  const double width = 1.0 + grown.max_x - grown.min_x;
  const double height = 1.0 + grown.max_y - grown.min_y;
  if (width * height > static_cast<double>(parameters_.max_cells)) {
    throw std::length_error("the map would grow to " + std::to_string(std::llround(width)) + " x " +
                            std::to_string(std::llround(height)) +
                            " cells, more than the limit of " +
                            std::to_string(parameters_.max_cells));
  }
  counts_.cover(grown.min_x, grown.min_y, grown.max_x, grown.max_y);
  box_ = grown;
}

// Visits the cells on the segment in order (Amanatides and Woo 1987); coordinates in cells. The
// number of steps per axis is fixed by the end cells, so rounding cannot lead past them.
void OccupancyMapper::trace(double x0, double y0, double x1, double y1, bool hit) {
  const int cx = static_cast<int>(std::floor(x0)), cy = static_cast<int>(std::floor(y0));
  const int ex = static_cast<int>(std::floor(x1)), ey = static_cast<int>(std::floor(y1));
  const double dx = x1 - x0, dy = y1 - y0;
  int steps_x = std::abs(ex - cx), steps_y = std::abs(ey - cy);
  const int step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? 1 : -1;
  constexpr double kNever = 1e300;
  const double delta_x = steps_x > 0 ? std::abs(1.0 / dx) : kNever;
  const double delta_y = steps_y > 0 ? std::abs(1.0 / dy) : kNever;
  double next_x = steps_x > 0 ? (dx > 0 ? cx + 1 - x0 : x0 - cx) * delta_x : kNever;
  double next_y = steps_y > 0 ? (dy > 0 ? cy + 1 - y0 : y0 - cy) * delta_y : kNever;

  // From cell to cell within a tile, and asked for anew where the beam enters another one.
  constexpr int kSide = TiledGrid<Counts>::kSide;
  const auto enters = [](int cell, int step) {
    const int before = cell - step;
    return (cell ^ before) >= kSide || (cell ^ before) < 0;
  };
  int x = cx, y = cy;
  Counts* cell = counts_.at(x, y);
  for (int left = steps_x + steps_y; left > 0; --left) {
    ++cell->misses;
    if (steps_y == 0 || (steps_x > 0 && next_x < next_y)) {
      next_x += delta_x;
      x += step_x;
      cell = enters(x, step_x) ? counts_.at(x, y) : cell + step_x;
      --steps_x;
    } else {
      next_y += delta_y;
      y += step_y;
      cell = enters(y, step_y) ? counts_.at(x, y) : cell + step_y * kSide;
      --steps_y;
    }
  }
  if (hit) {
    ++cell->hits;
  } else {
    ++cell->misses;
  }
}

void OccupancyMapper::insert(const Pose2& base_in_map, const LaserScan& scan) {
  const Pose2 laser = base_in_map * scan.laser_in_base;
  if (!laser.isFinite()) {
    throw InputError("scan", "", "its pose is not finite");
  }
  const double to_cells = 1.0 / parameters_.resolution;
  const double x0 = laser.x * to_cells, y0 = laser.y * to_cells;
  const double clears =
      std::min({parameters_.no_return_clears, parameters_.usable_range, scan.range_max});

  // End points first: the map must cover them before the beams are traced without checks.
  ends_.clear();  // x, y, hit
  double min_x = x0, max_x = x0, min_y = y0, max_y = y0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double r = scan.ranges[i];
    if (!(r >= scan.range_min)) continue;  // says nothing (NaN too)
    const bool is_return = r < scan.range_max;
    const bool hit = is_return && r <= parameters_.usable_range;
    const double length = is_return ? std::min(r, parameters_.usable_range) : clears;
    if (length <= 0.0) continue;
    const double bearing =
        laser.theta + scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const double x = x0 + length * std::cos(bearing) * to_cells;
    const double y = y0 + length * std::sin(bearing) * to_cells;
    ends_.insert(ends_.end(), {x, y, hit ? 1.0 : 0.0});
    min_x = std::min(min_x, x);
    max_x = std::max(max_x, x);
    min_y = std::min(min_y, y);
    max_y = std::max(max_y, y);
  }
  ++scans_;
  if (ends_.empty()) return;
  if (!(std::max({std::abs(min_x), std::abs(max_x), std::abs(min_y), std::abs(max_y)}) <
        kMaxCellCoordinate)) {
    --scans_;
    throw std::length_error("a scan lies too far from the origin of the map");
  }
  try {
    cover({static_cast<int>(std::floor(min_x)), static_cast<int>(std::floor(min_y)),
           static_cast<int>(std::floor(max_x)), static_cast<int>(std::floor(max_y))});
  } catch (...) {
    --scans_;
    throw;
  }
  for (std::size_t i = 0; i < ends_.size(); i += 3) {
    trace(x0, y0, ends_[i], ends_[i + 1], ends_[i + 2] > 0.5);
  }
}

OccupancyGrid OccupancyMapper::grid() const {
  Box seen{box_.max_x, box_.max_y, box_.min_x, box_.min_y};
  bool any = false;
  forEachObserved([&](int x, int y, std::uint32_t, std::uint32_t) {
    any = true;
    seen = {std::min(seen.min_x, x), std::min(seen.min_y, y), std::max(seen.max_x, x),
            std::max(seen.max_y, y)};
  });
  GridGeometry geometry;
  geometry.resolution = parameters_.resolution;
  if (!any) {
    geometry.width = geometry.height = 1;
    return OccupancyGrid(geometry);
  }
  constexpr int kMargin = 2;
  geometry.width = seen.max_x - seen.min_x + 1 + 2 * kMargin;
  geometry.height = seen.max_y - seen.min_y + 1 + 2 * kMargin;
  geometry.origin = {(seen.min_x - kMargin) * parameters_.resolution,
                     (seen.min_y - kMargin) * parameters_.resolution, 0.0};
  OccupancyGrid grid(geometry);
  forEachObserved([&](int x, int y, std::uint32_t hits, std::uint32_t misses) {
    const double total = static_cast<double>(hits) + misses;
    if (total < parameters_.min_observations) return;
    grid.at({x - seen.min_x + kMargin, y - seen.min_y + kMargin}) =
        hits > parameters_.occupied_ratio * total ? OccupancyGrid::kOccupied : OccupancyGrid::kFree;
  });
  return grid;
}

}  // namespace hyselam

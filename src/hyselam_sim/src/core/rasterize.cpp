#include "hyselam_sim/rasterize.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/plan_geometry.hpp"

namespace hyselam_sim {
namespace {

using hyselam::Cell;
using hyselam::GridGeometry;
using hyselam::OccupancyGrid;

constexpr double kMaxCells = 4e8;
// A surface on the border between two cells belongs to the solid's side only. [m]
constexpr double kTouch = 1e-3;

// Calls `mark(cell)` for every cell that holds a part of the outline or of what it encloses.
template <typename Mark>
void forCellsOf(const Polygon& outline, const GridGeometry& g, Mark mark) {
  const auto box = [&](Point2 low, Point2 high, auto visit) {
    Cell a = g.cellAt(low - Point2{kTouch, kTouch}), b = g.cellAt(high + Point2{kTouch, kTouch});
    a = {std::max(a.x, 0), std::max(a.y, 0)};
    b = {std::min(b.x, g.width - 1), std::min(b.y, g.height - 1)};
    for (int y = a.y; y <= b.y; ++y) {
      for (int x = a.x; x <= b.x; ++x) visit(Cell{x, y});
    }
  };
  Point2 low = outline[0], high = outline[0];
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Segment s{outline[i], outline[(i + 1) % outline.size()]};
    low = {std::min(low.x, s.a.x), std::min(low.y, s.a.y)};
    high = {std::max(high.x, s.a.x), std::max(high.y, s.a.y)};
    const double half = 0.5 * g.resolution - std::min(kTouch, 0.1 * g.resolution);
    box({std::min(s.a.x, s.b.x), std::min(s.a.y, s.b.y)},
        {std::max(s.a.x, s.b.x), std::max(s.a.y, s.b.y)}, [&](Cell c) {
          const Point2 m = g.center(c);
          if (touchesBox(s, m - Point2{half, half}, m + Point2{half, half})) mark(c);
        });
  }
  box(low, high, [&](Cell c) {
    if (contains(outline, g.center(c))) mark(c);
  });
}

std::vector<Point2> interiorPoints(const FloorPlan& plan) {
  std::vector<Point2> seeds = plan.inside;
  for (const PlanPlace& place : plan.places) seeds.push_back(place.at);
  return seeds;
}

}  // namespace

void RasterOptions::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("resolution", resolution, Range::between(0.005, 10.0), "m", "of a cell");
  visit("time", time, Range::any(), "s", "at which the doors are drawn");
  visit("with_furniture", with_furniture, "false: the floor under it is free");
}

void RasterOptions::validate() const {
  hyselam::checkParameters(*this);
}

OccupancyGrid rasterize(const FloorPlan& plan, const RasterOptions& options) {
  const double r = options.resolution;
  options.validate();
  const double columns = std::ceil(plan.size.x / r - 1e-9),
               rows = std::ceil(plan.size.y / r - 1e-9);
  if (columns * rows > kMaxCells) {
    throw hyselam::InputError(plan.source, "key 'size'", "too large for that resolution");
  }
  GridGeometry g;
  g.width = std::max(1, static_cast<int>(columns));
  g.height = std::max(1, static_cast<int>(rows));
  g.resolution = r;
  g.origin = {plan.origin.x, plan.origin.y, 0.0};

  OccupancyGrid grid(g, OccupancyGrid::kUnknown);
  for (const Solid& wall : wallSolids(plan)) {
    forCellsOf(wall.outline, g, [&](Cell c) { grid.at(c) = OccupancyGrid::kOccupied; });
  }

  // The interior: a flood from the named points, stopped by walls only.
  std::vector<Cell> front;
  const auto visit = [&](Cell c) {
    if (!g.contains(c)) {
      const Point2 p = g.center(c);
      std::ostringstream reason;
      reason << "the interior is not closed: free floor reaches the edge of the drawing near ["
             << p.x << ", " << p.y << "]";
      throw hyselam::InputError(plan.source, "key 'walls'", reason.str());
    }
    if (grid.at(c) != OccupancyGrid::kUnknown) return;
    grid.at(c) = OccupancyGrid::kFree;
    front.push_back(c);
  };
  const std::vector<Point2> seeds = interiorPoints(plan);
  if (seeds.empty()) {
    throw hyselam::InputError(plan.source, "key 'places'",
                              "no place and no 'inside' point tells where the interior is");
  }
  for (const Point2& seed : seeds) visit(g.cellAt(seed));
  while (!front.empty()) {
    const Cell c = front.back();
    front.pop_back();
    visit({c.x + 1, c.y});
    visit({c.x - 1, c.y});
    visit({c.x, c.y + 1});
    visit({c.x, c.y - 1});
  }

  for (const Solid& solid : solids(plan, options.time, options.with_furniture)) {
    if (solid.kind == Solid::Kind::kWall) continue;
    forCellsOf(solid.outline, g, [&](Cell c) { grid.at(c) = OccupancyGrid::kOccupied; });
  }
  return grid;
}

OccupancyGrid rasterize(const FloorPlan& plan, double resolution, double time) {
  RasterOptions options;
  options.resolution = resolution;
  options.time = time;
  return rasterize(plan, options);
}

}  // namespace hyselam_sim

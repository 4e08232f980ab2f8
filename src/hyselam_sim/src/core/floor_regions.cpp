#include "hyselam_sim/floor_regions.hpp"

#include <deque>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace hyselam_sim {
namespace {

using hyselam::Cell;
using hyselam::GridGeometry;
using hyselam::OccupancyGrid;

constexpr int kMaxLabels = 32000;

// Spreads the labels of the cells in `front` over unlabelled cells (-1) that `passable` lets in.
template <typename Passable>
void spread(const GridGeometry& g, std::deque<Cell> front, std::vector<std::int16_t>& labels,
            Passable passable) {
  while (!front.empty()) {
    const Cell c = front.front();
    front.pop_front();
    for (const Cell next :
         {Cell{c.x + 1, c.y}, Cell{c.x - 1, c.y}, Cell{c.x, c.y + 1}, Cell{c.x, c.y - 1}}) {
      if (!g.contains(next) || labels[g.index(next)] >= 0 || !passable(next)) continue;
      labels[g.index(next)] = labels[g.index(c)];
      front.push_back(next);
    }
  }
}

std::deque<Cell> labelled(const GridGeometry& g, const std::vector<std::int16_t>& labels) {
  std::deque<Cell> cells;
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      if (labels[g.index({x, y})] >= 0) cells.push_back({x, y});
    }
  }
  return cells;
}

}  // namespace

FloorRegions::FloorRegions(const FloorPlan& plan, double resolution) {
  FloorPlan shut = plan;
  for (PlanDoor& door : shut.doors) {
    door.initially_open = false;
    door.schedule.clear();
  }
  RasterOptions options;
  options.resolution = resolution;
  options.with_furniture = false;
  const OccupancyGrid grid = rasterize(shut, options);
  geometry_ = grid.geometry;
  const GridGeometry& g = geometry_;
  const auto is_floor = [&grid](Cell c) { return grid.at(c) == OccupancyGrid::kFree; };

  floor_.resize(g.cellCount());
  rooms_.assign(g.cellCount(), -1);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const Cell c{x, y};
      floor_[g.index(c)] = is_floor(c);
      if (!is_floor(c) || rooms_[g.index(c)] >= 0) continue;
      if (room_count_ >= kMaxLabels) {
        throw hyselam::InputError(plan.source, "key 'walls'",
                                  "the floor falls into too many parts");
      }
      rooms_[g.index(c)] = static_cast<std::int16_t>(room_count_++);
      spread(g, {c}, rooms_, is_floor);
    }
  }
  spread(g, labelled(g, rooms_), rooms_, [](Cell) { return true; });

  places_.assign(g.cellCount(), -1);
  std::deque<Cell> starts;
  for (std::size_t i = 0; i < plan.places.size(); ++i) {
    outlines_.push_back(plan.places[i].outline);
    const Cell c = g.cellAt(plan.places[i].at);
    if (!g.contains(c) || places_[g.index(c)] >= 0) continue;
    places_[g.index(c)] = static_cast<std::int16_t>(i);
    starts.push_back(c);
  }
  spread(g, starts, places_, is_floor);
  // Doorways and walls belong to the nearest floor; rooms without a place stay without one.
  std::vector<std::int16_t> filled = places_;
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (floor_[i] && filled[i] < 0) filled[i] = static_cast<std::int16_t>(plan.places.size());
  }
  spread(g, labelled(g, filled), filled, [](Cell) { return true; });
  for (std::int16_t& label : filled) {
    if (label == static_cast<std::int16_t>(plan.places.size())) label = -1;
  }
  places_ = std::move(filled);
}

int FloorRegions::lookUp(const std::vector<std::int16_t>& labels, Point2 p) const {
  const Cell c = geometry_.cellAt(p);
  return geometry_.contains(c) ? labels[geometry_.index(c)] : -1;
}

int FloorRegions::placeAt(Point2 p) const {
  for (std::size_t i = 0; i < outlines_.size(); ++i) {
    if (!outlines_[i].empty() && contains(outlines_[i], p)) return static_cast<int>(i);
  }
  return lookUp(places_, p);
}

bool FloorRegions::onFloor(Point2 p) const {
  const Cell c = geometry_.cellAt(p);
  return geometry_.contains(c) && floor_[geometry_.index(c)];
}

}  // namespace hyselam_sim

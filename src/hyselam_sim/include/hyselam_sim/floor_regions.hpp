// Which room and which named place a point of the floor belongs to: the truth for those who learn
// it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_sim {

/// Rooms are what walls and doorways enclose (doors count as shut). A point belongs to the place
/// whose outline holds it, else to the place of its room whose point is nearest by path length.
/// Immutable after construction; all queries may run concurrently.
class FloorRegions {
 public:
  /// Throws what rasterize() throws.
  explicit FloorRegions(const FloorPlan& plan, double resolution = 0.1);

  /// Number of the room, 0 .. rooms() - 1, of the nearest floor; -1 outside the drawing.
  int roomAt(Point2 p) const { return lookUp(rooms_, p); }
  int rooms() const { return room_count_; }

  /// Index into FloorPlan::places; -1 where no place is.
  int placeAt(Point2 p) const;

  /// Whether the point lies on the floor of the interior, not in a wall or doorway.
  bool onFloor(Point2 p) const;

  const hyselam::GridGeometry& geometry() const { return geometry_; }

 private:
  int lookUp(const std::vector<std::int16_t>& labels, Point2 p) const;

  hyselam::GridGeometry geometry_;
  std::vector<Polygon> outlines_;     ///< of the places, by index
  std::vector<std::int16_t> rooms_;   ///< of each cell, walls take their neighbour's
  std::vector<std::int16_t> places_;  ///< of each cell, without outlines
  std::vector<bool> floor_;
  int room_count_ = 0;
};

}  // namespace hyselam_sim

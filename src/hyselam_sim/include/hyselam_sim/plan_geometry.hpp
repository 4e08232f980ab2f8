// What of a floor plan is solid at a given time.
#pragma once

#include <string>
#include <vector>

#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_sim {

/// One solid body of the plan with where it comes from.
struct Solid {
  enum class Kind { kWall, kDoor, kFurniture };
  Kind kind = Kind::kWall;
  std::size_t index = 0;  ///< into FloorPlan::walls, doors or furniture
  Polygon outline;
};

/// Thickness of a door leaf [m].
constexpr double kLeafThickness = 0.05;

/// The walls with their door openings cut out.
std::vector<Solid> wallSolids(const FloorPlan& plan);

/// The leaf of a door at that time: shut in the opening, or standing at a right angle to it. Empty
/// outline for an open door without a swinging leaf.
Polygon doorLeaf(const PlanDoor& door, double time);

/// Everything a robot can hit at that time: walls, door leaves, furniture.
std::vector<Solid> solids(const FloorPlan& plan, double time, bool with_furniture = true);

/// The outlines' edges.
std::vector<Segment> edges(const std::vector<Solid>& solids);

/// "wall 'outer'", "door 3", ... for messages.
std::string describe(const FloorPlan& plan, const Solid& solid);

}  // namespace hyselam_sim

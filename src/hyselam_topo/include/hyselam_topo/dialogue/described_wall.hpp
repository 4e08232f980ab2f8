// Walls that a person has described, of glass or virtual, which no range sensor detects: as lines
// on the floor, drawn into a grid map, put into a topological map.
#pragma once

#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// A straight wall on the floor, from end to end, in the frame of the map [m].
struct WallLine {
  hyselam::Point2 a;
  hyselam::Point2 b;

  double length() const;
  double distanceTo(hyselam::Point2 point) const;  ///< from a point to the nearest point of it
};

bool operator==(const WallLine& a, const WallLine& b);

/// Whether two walls are one: their ends are within 0.3 m, in any order.
bool sameWall(const WallLine& a, const WallLine& b);

/// A virtual one that lies across a door shuts it (PlaceMan::doorShutBy()).
struct DescribedWall {
  WallLine line;
  WallKind kind = WallKind::kGlass;  ///< or kVirtual; never kSolid
};

bool operator==(const DescribedWall& a, const DescribedWall& b);

/// Makes the cells occupied that the walls cross, so that no 4- or 8-connected path leads
/// through; what lies outside of the grid is left out. Never draw into the grid of a SLAM, but into
/// a copy.
void drawWalls(const std::vector<WallLine>& walls, hyselam::OccupancyGrid* grid);

/// Puts the wall into the topological map, into the place that it limits (by the nearest cells on
/// its two sides; into both if they differ), unless it is there.
void putWall(const DescribedWall& described, AugmentedTopologicalMap* map);

}  // namespace hyselam_topo

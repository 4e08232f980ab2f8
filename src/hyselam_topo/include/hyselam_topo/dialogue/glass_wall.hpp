// Position of a glass wall that a person describes and no laser detects (dos Santos, section 7.2).
//
// "On your left there is a glass wall": the grid map is searched as a laser at the robot would see
// it, turned to that side. Glass walls are held by something solid, so they stand between two
// convex corners: the one nearest to the robot, and the next one to it.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_language/building/described_building.hpp"
#include "hyselam_topo/dialogue/described_wall.hpp"

namespace hyselam_topo {

struct GlassWallParams {
  double aperture = hyselam::kPi - hyselam::kPi / 6.0;  ///< alpha_laser [rad], (0, 2 pi]
  double range = 6.0;                                   ///< l_laser [m], > 0
  int corner_cells = 4;                                 ///< l_corner [cells], 2 .. 100
  /// alpha_corner [rad], (0, pi): by so much the angle that is free around a convex corner is wider
  /// than that before a straight wall.
  double corner_angle = 8.0 / 12.0;
  double min_length = 0.5;  ///< k [m]: two corners nearer than this are one post, > 0
  double max_length = 6.0;  ///< [m], > min_length
  int occupied_min = 65;    ///< cells of this or more are occupied, 1 .. 100

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a parameter out of range.
  void validate() const;
};

/// The search for a glass wall from one robot pose; of walls that people call virtual, too, which
/// stand between corners likewise.
class GlassWallSearch {
 public:
  /// Looks from `robot` (pose in the frame of the map) to a side. Throws hyselam::ParameterError
  /// for parameters out of range, hyselam::InputError for a side that is not known, a pose that is
  /// not finite or lies outside of the grid.
  GlassWallSearch(const hyselam::OccupancyGrid& grid, const hyselam::Pose2& robot, Side side,
                  const GlassWallParams& params = {});

  /// Between the corner nearest to the robot and the next one to it that it can be joined with; if
  /// it has none, the second nearest, and so on. Not one that was rejected.
  std::optional<WallLine> likeliest() const;
  /// The one whose length is nearest to the described one [m]; of equal ones the nearest to the
  /// robot. Not one that was rejected, unless it fits better by more than 0.3 m.
  std::optional<WallLine> ofLength(double length) const;
  /// Excludes a wall that a person has denied.
  void reject(const WallLine& wall);

  /// Convex corners, nearest to the robot first.
  const std::vector<hyselam::Point2>& corners() const { return corners_; }
  /// End points of the simulated laser beams, from right to left: the outline of the searched area.
  const std::vector<hyselam::Point2>& seen() const { return seen_; }
  const hyselam::Pose2& robot() const { return robot_; }
  Side side() const { return side_; }

 private:
  /// The walls between two corners, where `is_free` of their numbers.
  void joinCorners(const std::function<bool(std::size_t, std::size_t)>& is_free);
  bool rejected(const WallLine& wall) const;

  hyselam::Pose2 robot_;
  Side side_;
  GlassWallParams params_;
  std::vector<hyselam::Point2> corners_;
  std::vector<hyselam::Point2> seen_;
  std::vector<WallLine> pairs_;  // by the nearness of their first, then of their second corner
  std::vector<WallLine> rejected_;
};

// ---- Former names, until 2.0.0 ----

using GlassWall [[deprecated("it is a WallLine")]] = WallLine;
[[deprecated("use drawWalls()")]] inline void drawGlassWalls(const std::vector<WallLine>& walls,
                                                             hyselam::OccupancyGrid* grid) {
  drawWalls(walls, grid);
}
[[deprecated("use putWall()")]] inline void addGlassWalls(const std::vector<WallLine>& walls,
                                                          AugmentedTopologicalMap* map,
                                                          WallKind kind = WallKind::kGlass) {
  for (const WallLine& line : walls) putWall({line, kind}, map);
}

}  // namespace hyselam_topo

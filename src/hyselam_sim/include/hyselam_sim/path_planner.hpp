// Paths through a building that keep clear of the walls.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/geometry.hpp"

namespace hyselam_sim {

/// Distance to the nearest obstacle, everywhere.
class ClearanceMap {
 public:
  /// Everything but free cells is an obstacle. The grid must not be rotated.
  explicit ClearanceMap(const hyselam::OccupancyGrid& grid);

  /// [m], never more than the true clearance plus half a cell; 0 in and outside obstacles.
  double at(Point2 p) const;

  /// The same with discs of that radius [m] forbidden: the clearance there is 0.
  ClearanceMap without(const std::vector<Point2>& centers, double radius) const;

  const hyselam::GridGeometry& geometry() const { return geometry_; }

 private:
  hyselam::GridGeometry geometry_;
  cv::Mat meters_;  // CV_32F
};

struct PlannerParams {
  double min_clearance = 0.34;         ///< the path's centre line never comes nearer to a wall [m]
  double comfortable_clearance = 1.5;  ///< nearer than this costs extra [m]
  double discomfort = 4.0;  ///< extra cost at no clearance, in multiples of the path length
  double smooth_clearance =
      0.8;               ///< rounding of corners keeps this distance where there is room [m]
  double spacing = 0.1;  ///< of the path's points [m]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// The cheapest path (A* on an eight-connected lattice, then shortened and rounded), including both
/// ends; nothing if there is none.
std::optional<std::vector<Point2>> planPath(const ClearanceMap& clearance, Point2 from, Point2 to,
                                            const PlannerParams& params = {});

/// Points at most `spacing` apart along the straight line, both ends included.
std::vector<Point2> straightPath(Point2 from, Point2 to, double spacing);

}  // namespace hyselam_sim

// Walls of places (dos Santos 2014, Eq. 3.3 and section 4.2, fifth stage): what limits each place,
// as straight pieces and arcs: solid walls and virtual limits.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct WallParams {
  /// [m] how far a wall may run from the cells' faces, > 0; at least 0.9 cells
  double tolerance = 0.06;
  /// [m] shorter pieces join their neighbors in line or are left out, >= 0
  double min_length = 0.1;
  /// [m] around an obstacle within a place: smaller ones (pillars, tables) are no walls, >= 0
  double min_island = 6.0;
  double max_gap = 0.15;     ///< [m] unknown gaps in a wall up to this are wall, >= 0
  double max_radius = 25.0;  ///< [m] arcs with a larger radius are straight, > 0
  int free_max = 25;         ///< cells of 0 .. free_max are free, 0 .. 99
  int occupied_min = 65;     ///< cells from here on are walls, free_max < .. <= 100

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// The limits of one place.
struct PlaceWalls {
  /// In order around the place, counter-clockwise, then around the obstacles in it. Ids are 0,
  /// heights unknown. Solid where occupied cells stand, virtual where another place or the unknown
  /// begins.
  std::vector<Wall> walls;
  std::vector<hyselam::Point2> outline;  ///< corners of the outer limit, counter-clockwise
};

/// Walls of the places 1 .. n of a label image; element k belongs to label k + 1. Each wall is a
/// least squares fit to the faces of cells that it follows, and carries the covariance of that fit.
/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError if the labels
/// do not fit the grid.
std::vector<PlaceWalls> extractWalls(const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                                     const WallParams& params = {});

inline std::vector<PlaceWalls> extractWalls(const hyselam::OccupancyGrid& grid,
                                            const PlaceSegmentation& segmentation,
                                            const WallParams& params = {}) {
  return extractWalls(grid, segmentation.labels, params);
}

}  // namespace hyselam_topo

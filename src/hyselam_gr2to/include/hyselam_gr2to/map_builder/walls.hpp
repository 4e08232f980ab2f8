// Walls of places (dos Santos, Eq. 3.3 and section 4.2, fifth stage): what limits each place, as
// straight pieces and arcs, told apart into walls that are there and limits that are not.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_gr2to/segmentation/segmentation.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct WallParams {
  double tolerance =
      0.06;  ///< [m] how far a wall may run from the cells' faces, > 0; at least 0.9 cells
  double min_length =
      0.1;  ///< [m] shorter pieces join their neighbours in line or are left out, >= 0
  /// [m] around an obstacle within a place: smaller ones (pillars, tables) are no walls, >= 0
  double min_island = 6.0;
  double close_gaps = 0.15;  ///< [m] unknown gaps in a wall up to this are wall, >= 0
  double max_radius = 25.0;  ///< [m] arcs with a larger radius are straight, > 0
  int free_max = 25;         ///< cells of 0 .. free_max are free [0 .. 100]
  int occupied_min = 65;     ///< cells from here on are walls [0 .. 100], > free_max
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
/// @throws hyselam::ParameterError for a parameter out of range, std::invalid_argument if the
/// labels do not fit the grid.
std::vector<PlaceWalls> extractWalls(const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                                     const WallParams& params = {});

inline std::vector<PlaceWalls> extractWalls(const hyselam::OccupancyGrid& grid,
                                            const Segmentation& segmentation,
                                            const WallParams& params = {}) {
  return extractWalls(grid, segmentation.labels, params);
}

}  // namespace hyselam_topo

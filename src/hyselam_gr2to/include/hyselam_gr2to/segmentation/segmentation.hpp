// Splits the free space of a grid map into the places that people see in it: the default mode of
// Gr2To. The places are found on geometry alone; walls, graph and map are built from them.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"

namespace hyselam_topo {

/// The line on which two places meet.
struct DoorLine {
  hyselam::Point2 a;   ///< one end [m], map frame
  hyselam::Point2 b;   ///< the other end [m], map frame
  double width = 0.0;  ///< passage width [m]
  bool real = true;    ///< a door-like opening in a wall; false: an open border between two places
  int place_a = 0;     ///< the two labels that it connects
  int place_b = 0;
};

/// Places as labels of the cells.
struct Segmentation {
  cv::Mat labels;  ///< CV_16U, the grid's size, row 0 = lowest y (as hyselam::OccupancyGrid);
                   ///< 0 outside, 1 .. places the place of a cell
  int places = 0;  ///< how many; labels are 1 .. places without gaps, each 4-connected
  std::vector<DoorLine> doors;  ///< sorted by (place_a, place_b, a)
};

struct SegmentationParams {
  int free_max = 25;  ///< cells of 0 .. free_max are free, 0 .. 99
  /// Finer grids are joined, coarser ones split to about this [m], 0.01 .. 0.25; what is known
  /// about borders was learnt at 0.05.
  double working_resolution = 0.05;
  double clutter = 0.7;  ///< obstacles up to this across that stand free do not part places [m]
  double smallest_place = 1.0;  ///< [m^2]
};

/// Places, and the doors between them. The same grid gives the same result, bit by bit; a grid
/// without free space gives no places.
/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError for a grid
/// without cells or whose cells do not fit its geometry.
Segmentation segment(const hyselam::OccupancyGrid& grid, const SegmentationParams& params = {});

/// The two halves of segment(): places alone, and the doors of given places.
Segmentation segmentPlaces(const hyselam::OccupancyGrid& grid,
                           const SegmentationParams& params = {});
void addDoors(const hyselam::OccupancyGrid& grid, Segmentation& places,
              const SegmentationParams& params = {});

}  // namespace hyselam_topo

// Place segmentation, the default mode of Gr2To: splits the free space of a grid map into the rooms
// and corridors that people see in it, by geometry alone. Walls, graph and map are built from them.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"

namespace hyselam_topo {

class BorderModel;

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
struct PlaceSegmentation {
  cv::Mat labels;  ///< CV_16U, the grid's size, row 0 = lowest y (as hyselam::OccupancyGrid);
                   ///< 0 outside, 1 .. places the place of a cell
  int places = 0;  ///< how many; labels are 1 .. places without gaps, each 4-connected
  std::vector<DoorLine> doors;  ///< sorted by (place_a, place_b, a)
};

struct SegmentationParams {
  int free_max = 25;  ///< cells of 0 .. free_max are free, 0 .. 99
  /// Cells of finer grids are joined, those of coarser ones split to about this size [m], 0.01 ..
  /// 0.25; the shipped border model was trained at 0.05.
  double working_resolution = 0.05;
  /// Free-standing obstacles up to this size [m] do not separate places, 0 .. 5.
  double max_clutter_size = 0.7;
  double min_place_area = 1.0;  ///< smaller ones join a neighbor or are left out [m^2], 0 .. 100
  /// Decides which neighboring regions are one place; null: BorderModel::shipped().
  std::shared_ptr<const BorderModel> border_model;

  /// All but the model.
  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Places, and the doors between them. The same grid gives the same result, bit by bit; a grid
/// without free space gives no places.
/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError for a grid
/// without cells or whose cells do not fit its geometry.
PlaceSegmentation segment(const hyselam::OccupancyGrid& grid,
                          const SegmentationParams& params = {});

/// The two halves of segment(): places alone, and the doors of given places.
PlaceSegmentation segmentPlaces(const hyselam::OccupancyGrid& grid,
                                const SegmentationParams& params = {});
void addDoors(const hyselam::OccupancyGrid& grid, PlaceSegmentation& places,
              const SegmentationParams& params = {});

}  // namespace hyselam_topo

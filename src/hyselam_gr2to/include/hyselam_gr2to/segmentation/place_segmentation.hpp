// Place segmentation, the default mode of Gr2To (grid map to topological map): splits the free
// space of a grid map into the places (rooms and corridors) that humans would identify, by geometry
// alone. Walls, graph and topological map are built from them.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"

namespace hyselam_topo {

class BorderModel;

/// The border segment between two adjacent places.
struct DoorLine {
  hyselam::Point2 a;   ///< one end [m], map frame
  hyselam::Point2 b;   ///< the other end [m], map frame
  double width = 0.0;  ///< passage width [m]
  bool real = true;    ///< a door-like opening in a wall; false: an open border between two places
  int place_a = 0;     ///< label of one place
  int place_b = 0;     ///< label of the other place
};

/// The grid's cells labeled by place.
struct PlaceSegmentation {
  cv::Mat labels;  ///< CV_16U, the grid's size, row 0 = lowest y (as hyselam::OccupancyGrid);
                   ///< 0 outside, 1 .. places the place of a cell
  int places = 0;  ///< number of places; labels are 1 .. places without gaps, each 4-connected
  std::vector<DoorLine> doors;  ///< sorted by (place_a, place_b, a)
};

struct SegmentationParams {
  int free_max = 25;  ///< cells of 0 .. free_max are free, 0 .. 99
  /// Cell size to work at [m], 0.01 .. 0.25: finer grids are downsampled, coarser ones upsampled to
  /// about this. The built-in border model was trained at 0.05.
  double working_resolution = 0.05;
  /// Free-standing obstacles up to this size [m] do not separate places, 0 .. 5.
  double max_clutter_size = 0.7;
  /// Smaller places are merged with a neighbor or left out [m^2], 0 .. 100.
  double min_place_area = 1.0;
  /// Decides which neighboring regions are one place; null: the built-in one
  /// (BorderModel::shipped()).
  std::shared_ptr<const BorderModel> border_model;

  /// All members but the border model.
  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Places, and the doors between them. The same grid gives a bit-identical result; a grid without
/// free space gives no places.
/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError for a grid
/// without cells, whose cell count differs from width x height, or whose resolution is not finite
/// and > 0.
PlaceSegmentation segment(const hyselam::OccupancyGrid& grid,
                          const SegmentationParams& params = {});

/// The two steps of segment(): places without doors, and the doors of given places.
PlaceSegmentation segmentPlaces(const hyselam::OccupancyGrid& grid,
                                const SegmentationParams& params = {});
void addDoors(const hyselam::OccupancyGrid& grid, PlaceSegmentation& places,
              const SegmentationParams& params = {});

}  // namespace hyselam_topo

// Doors from the borders between places: where exactly the passage is, how wide, and whether it is
// a door or an open border. Beyond the thesis, whose doors come from the distance map alone
// (door_candidates.hpp) and miss all that have no standard width.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"

namespace hyselam_topo {

struct DoorParams {
  double min_width = 0.45;  ///< [m] of a real door, > 0
  double max_width = 2.3;   ///< [m] of a real door, > min_width
  /// [m] how far the line may move away from the border to where the passage is narrowest, 0 .. 10.
  double search_radius = 1.0;
  /// [m] by how much both places must be wider than a real door, within `jamb_depth` of it, > 0.
  double min_jambs = 0.15;
  double jamb_depth = 1.2;  ///< [m] 0 .. 10, not 0
  int free_max = 25;        ///< cells of 0 .. free_max are free, 0 .. 99

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// A door line for each border between two places. The line leads from wall to wall where the
/// passage is narrowest. It is a real door if it has a door's width and both places are wider than
/// it within a short way behind it: jambs on both sides. Two borders of the same places with the
/// same line give one door. Of several between the same places those that end at something that
/// stands free, less than 2.5 m across, are open borders. Sorted by (place_a, place_b, a).
/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError if the labels
/// do not fit the grid.
std::vector<DoorLine> refineDoors(const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                                  const DoorParams& params = {});

}  // namespace hyselam_topo

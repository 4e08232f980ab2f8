// Gr2To (grid map to topological map, dos Santos 2014, section 4.2): from an occupancy grid to the
// augmented topological map.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/map_builder/map_builder.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "hyselam_gr2to/thesis/thesis.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct Gr2ToParams {
  enum class Mode {
    kDefault,  ///< segment(): regions merged by a learnt model, clutter does not separate places
    kThesis,   ///< runThesis(): critical points of the Voronoi diagram, as in the thesis
  };
  Mode mode = Mode::kDefault;
  /// Of mode default; its `free_max` holds in both modes, and for walls.
  SegmentationParams segmentation;
  /// Of mode thesis; its own `free_max` is not used.
  ThesisParams thesis;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

struct Gr2ToResult {
  AugmentedTopologicalMap map;
  cv::Mat labels;  ///< CV_16U as in PlaceSegmentation; label n is map place n
  std::vector<DoorLine> doors;
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage [s], in order
};

/// @throws hyselam::ParameterError for a parameter out of range, hyselam::InputError for a grid
/// without cells or whose cell count differs from width x height.
Gr2ToResult gr2to(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params = {});

/// How gr2to() builds the map of its places: the defaults with its limits of free and occupied.
MapBuilderParams mapBuilderParams(const Gr2ToParams& params);

/// "default", "thesis".
const char* toString(Gr2ToParams::Mode mode);

}  // namespace hyselam_topo

// The parameters of a map that a server draws, SLAM's own or that of several robots.
#pragma once

#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/parameters.hpp"

namespace ngram_slam {

constexpr int kMostMapCells = 50000000;

inline void describeDrawnMap(hyselam::OccupancyMapperParams& map,
                             hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("resolution", map.resolution, Range::between(0.01, 1.0), "m/cell", "of the map");
  visit("usable_range", map.usable_range, Range::above(0.0), "m",
        "farther returns clear the beam up to here only");
  visit("occupied_ratio", map.occupied_ratio, Range::inside(0.0, 1.0), "",
        "hits / (hits + misses) of an occupied cell");
  visit("max_map_cells", map.max_cells, Range::between(1, 1e9), "", "growth beyond is refused");
}

}  // namespace ngram_slam

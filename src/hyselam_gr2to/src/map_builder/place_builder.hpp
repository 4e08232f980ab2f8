// Places, edges and the grid's relation, piece by piece: what buildTopologicalMap() and an update
// of a part have in common.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <set>
#include <vector>

#include "hyselam_gr2to/map_builder/map_builder.hpp"

namespace hyselam_topo {

/// Which labels to build, and where they are.
struct PlaceSelection {
  std::vector<char> wanted;    ///< by label; empty: all
  std::vector<char> measured;  ///< by label; empty: all. Others get walls and outline only
  cv::Rect box;                ///< holds all cells of the wanted ones
  cv::Rect measured_box;       ///< holds all cells of the measured ones
};

using Neighbors = std::map<int, std::set<int>>;
Neighbors neighborsOf(const std::vector<DoorLine>& doors);

/// The selected places in the order of their labels, ids = labels, ids of walls 0.
std::vector<Place> buildPlaces(const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                               int places, const Neighbors& neighbors,
                               const MapBuilderParams& params, const PlaceSelection& selection);

/// Puts places into a map whose place k has label k, with edges, relation to the grid and all ids.
AugmentedTopologicalMap assembleMap(const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                                    std::vector<Place> places, const std::vector<DoorLine>& doors);

}  // namespace hyselam_topo

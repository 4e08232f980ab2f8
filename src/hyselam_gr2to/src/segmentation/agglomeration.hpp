// Fourth step of the segmentation: neighbours become one place, the surest first, until no pair is
// more likely one place than two.
#pragma once

#include <functional>
#include <opencv2/core.hpp>

#include "boosted_trees.hpp"
#include "free_space.hpp"
#include "place_graph.hpp"

namespace hyselam_topo {

/// Log-odds that two neighbours with an open border are one place.
using OnePlace = std::function<double(const PlaceGraph&, int a, int b)>;

/// Ties go to the pair with the smaller numbers; the smaller number is kept.
void agglomerate(PlaceGraph& graph, const OnePlace& odds);

/// Steps one to three.
struct PreparedPlaces {
  FreeSpace space;
  cv::Mat clearance;  ///< CV_32F [cells]
  Basins basins;
};
PreparedPlaces preparePlaces(const hyselam::OccupancyGrid& grid, const SegmentationParams& params);

/// The trees that come with the package; train_borders makes them.
const BoostedTrees& borderModel();

/// Log-odds by the trees, as a mean over lengths and clearances around those measured: a cell more
/// or less, or a building a tenth larger, should not decide.
double oddsOfOnePlace(const BoostedTrees& model, const BorderFeatures& border);

}  // namespace hyselam_topo

// The features of a border of the region adjacency graph.
#pragma once

#include "hyselam_gr2to/segmentation/border_features.hpp"
#include "region_adjacency_graph.hpp"

namespace hyselam_topo {

/// `a` and `b`: two living neighbours of the graph.
BorderFeatures describeBorder(const RegionAdjacencyGraph& graph, int a, int b);

}  // namespace hyselam_topo

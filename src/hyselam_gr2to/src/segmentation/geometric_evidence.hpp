// What straight corridors and furniture tell about a border, besides what the border model has
// learnt of its shape.
#pragma once

#include "region_adjacency_graph.hpp"

namespace hyselam_topo {

/// Log-odds to add to those of the border model that `a` and `b`, two living neighbours, are one
/// place.
double geometricEvidence(const RegionAdjacencyGraph& graph, int a, int b);

}  // namespace hyselam_topo

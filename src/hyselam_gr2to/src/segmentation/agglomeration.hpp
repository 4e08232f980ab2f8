// Fourth step of the segmentation: neighbours become one place, the surest first, until no pair is
// more likely one place than two.
#pragma once

#include <functional>

#include "region_adjacency_graph.hpp"

namespace hyselam_topo {

/// Log-odds that two neighbours with an open border are one place.
using OnePlace = std::function<double(const RegionAdjacencyGraph&, int a, int b)>;

/// Ties go to the pair with the smaller numbers; the smaller number is kept.
void agglomerate(RegionAdjacencyGraph& graph, const OnePlace& odds);

}  // namespace hyselam_topo

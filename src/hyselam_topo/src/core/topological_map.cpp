#include "hyselam_topo/topological_map.hpp"

#include <algorithm>

namespace hyselam_topo {

const Place* AugmentedTopologicalMap::findPlace(Id id) const {
  const auto it =
      std::find_if(places.begin(), places.end(), [&](const Place& p) { return p.id == id; });
  return it == places.end() ? nullptr : &*it;
}

Place* AugmentedTopologicalMap::findPlace(Id id) {
  return const_cast<Place*>(static_cast<const AugmentedTopologicalMap*>(this)->findPlace(id));
}

const Edge* AugmentedTopologicalMap::findEdge(Id a, Id b) const {
  const auto ends = std::minmax(a, b);
  const auto it = std::find_if(edges.begin(), edges.end(), [&](const Edge& e) {
    return e.a == ends.first && e.b == ends.second;
  });
  return it == edges.end() ? nullptr : &*it;
}

Edge* AugmentedTopologicalMap::findEdge(Id a, Id b) {
  return const_cast<Edge*>(static_cast<const AugmentedTopologicalMap*>(this)->findEdge(a, b));
}

}  // namespace hyselam_topo

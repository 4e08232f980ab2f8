#include "neighbors.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "hyselam_topo/topomerg/shared_walls.hpp"

namespace hyselam_topo {
namespace {

bool has(const std::vector<Id>& all, Id id) {
  return std::find(all.begin(), all.end(), id) != all.end();
}

}  // namespace

bool areJoined(const AugmentedTopologicalMap& map, const std::vector<Id>& a,
               const std::vector<Id>& b) {
  return std::any_of(map.edges.begin(), map.edges.end(), [&](const Edge& edge) {
    return (has(a, edge.a) && has(b, edge.b)) || (has(a, edge.b) && has(b, edge.a));
  });
}

std::vector<Id> neighborsOf(const AugmentedTopologicalMap& map, const std::vector<Id>& places) {
  std::set<Id> all;
  for (const Edge& edge : map.edges) {
    for (const Id place : places) {
      if (edge.a == place) all.insert(edge.b);
      if (edge.b == place) all.insert(edge.a);
    }
  }
  for (const Id place : places) all.erase(place);
  return {all.begin(), all.end()};
}

std::vector<Id> placesBehind(const AugmentedTopologicalMap& map, const std::vector<Id>& places) {
  const std::vector<Id> neighbors = neighborsOf(map, places);
  std::vector<Id> behind;
  for (const SharedWall& wall : sharedWalls(map)) {
    const Id a = map.places[wall.a].id, b = map.places[wall.b].id;
    for (const auto& [here, there] : {std::pair(a, b), std::pair(b, a)}) {
      if (!has(places, here) || has(places, there) || has(neighbors, there)) continue;
      if (!has(behind, there)) behind.push_back(there);
    }
  }
  return behind;
}

bool areNeighbors(const AugmentedTopologicalMap& map, Id a, Id b) {
  if (map.findEdge(a, b) != nullptr) return true;
  const std::vector<SharedWall> walls = sharedWalls(map);
  return std::any_of(walls.begin(), walls.end(), [&](const SharedWall& wall) {
    const Id one = map.places[wall.a].id, other = map.places[wall.b].id;
    return (one == a && other == b) || (one == b && other == a);
  });
}

bool haveCommonNeighbor(const AugmentedTopologicalMap& map, Id a, Id b) {
  return std::any_of(map.places.begin(), map.places.end(), [&](const Place& place) {
    return map.findEdge(a, place.id) != nullptr && map.findEdge(b, place.id) != nullptr;
  });
}

}  // namespace hyselam_topo

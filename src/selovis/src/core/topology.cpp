#include "selovis/topology.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_topo/topological_map_xml.hpp"

namespace selovis {

using hyselam_topo::AugmentedTopologicalMap;
using hyselam_topo::Id;

namespace {

std::map<Id, std::string> namesOf(const AugmentedTopologicalMap& map) {
  std::map<Id, std::string> names;
  for (const auto& place : map.places) names[place.id] = hyselam_topo::nameOf(place);
  return names;
}

}  // namespace

PlaceGraph graphOf(const AugmentedTopologicalMap& map) {
  PlaceGraph graph;
  const auto names = namesOf(map);
  for (const auto& [id, name] : names) {
    if (graph.find(name) < 0) graph.places.push_back(name);
  }
  for (const auto& edge : map.edges) {
    const auto a = names.find(edge.a), b = names.find(edge.b);
    if (a == names.end() || b == names.end()) continue;
    const int i = graph.find(a->second), j = graph.find(b->second);
    if (i != j && !graph.connected(i, j)) {
      graph.transitions.emplace_back(std::min(i, j), std::max(i, j));
    }
  }
  return graph;
}

PlaceGraph readTopology(const std::string& path) {
  const std::string text = hyselam::readTextFile(path, hyselam_topo::XmlLimits().max_bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && text[first] == '<') {
    return graphOf(hyselam_topo::fromXml(text, path));
  }
  return readPlaceGraph(path);
}

std::vector<std::string> placesNear(const AugmentedTopologicalMap& map, hyselam::Point2 point,
                                    double reach) {
  std::vector<std::string> names;
  if (!map.grid || !std::isfinite(point.x) || !std::isfinite(point.y)) return names;
  const auto& grid = *map.grid;
  const hyselam::Pose2 in_grid =
      grid.geometry.origin.inverse() * hyselam::Pose2{point.x, point.y, 0.0};
  const double r = grid.geometry.resolution;
  if (std::abs(in_grid.x / r) > 1e8 || std::abs(in_grid.y / r) > 1e8) return names;
  const int col = static_cast<int>(std::floor(in_grid.x / r)),
            row = static_cast<int>(std::floor(in_grid.y / r));
  const int cells = static_cast<int>(std::ceil(reach / r));
  std::vector<std::pair<int, Id>> found;  // squared distance, place
  for (int dy = -cells; dy <= cells; ++dy) {
    for (int dx = -cells; dx <= cells; ++dx) {
      const int square = dx * dx + dy * dy;
      if (square * r * r > reach * reach) continue;
      const Id id = grid.placeOf({col + dx, row + dy});
      if (id != 0) found.emplace_back(square, id);
    }
  }
  std::sort(found.begin(), found.end());
  for (const auto& [square, id] : found) {
    const auto* place = map.findPlace(id);
    if (place == nullptr) continue;
    const std::string name = hyselam_topo::nameOf(*place);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::vector<int> placesInSight(const AugmentedTopologicalMap& map, const PlaceGraph& learnt,
                               const std::vector<std::string>& near) {
  if (near.empty() || learnt.find(near.front()) < 0) return {};
  const auto names = namesOf(map);
  const auto isVirtual = [&](Id id) {
    const auto* place = map.findPlace(id);
    return place != nullptr && place->kind == hyselam_topo::PlaceKind::kVirtual;
  };
  const auto joinedTo = [&](const std::set<Id>& ids) {
    std::set<Id> joined;
    for (const auto& edge : map.edges) {
      if (ids.count(edge.a) != 0) joined.insert(edge.b);
      if (ids.count(edge.b) != 0) joined.insert(edge.a);
    }
    return joined;
  };
  std::set<Id> own, own_virtual;
  for (const auto& [id, name] : names) {
    if (name != near.front()) continue;
    own.insert(id);
    if (isVirtual(id)) own_virtual.insert(id);
  }
  // Around a virtual place is a room, which is seen from there, and what else was told to be in it.
  const std::set<Id> around = joinedTo(own_virtual);
  own.insert(around.begin(), around.end());

  std::set<std::string> in_sight(near.begin(), near.end());
  const std::set<Id> beside = joinedTo(own);
  for (const auto& [id, name] : names) {
    if (around.count(id) != 0 || (beside.count(id) != 0 && isVirtual(id))) in_sight.insert(name);
  }
  std::set<std::string> on_map;
  for (const auto& [id, name] : names) on_map.insert(name);
  std::vector<int> places;
  for (std::size_t i = 0; i < learnt.places.size(); ++i) {
    const std::string& name = learnt.places[i];
    if (in_sight.count(name) != 0 || on_map.count(name) == 0) places.push_back(static_cast<int>(i));
  }
  return places;
}

std::optional<PlaceSpread> spreadOf(const AugmentedTopologicalMap& map, const std::string& name) {
  if (!map.grid) return {};
  const auto& grid = *map.grid;
  const double r = grid.geometry.resolution;
  std::map<Id, bool> wanted;
  for (const auto& place : map.places) wanted[place.id] = hyselam_topo::nameOf(place) == name;
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int col = 0; col < grid.geometry.width; ++col) {
      const Id id = grid.placeOf({col, row});
      if (id == 0 || !wanted[id]) continue;
      const hyselam::Point2 p =
          grid.geometry.origin * hyselam::Point2{(col + 0.5) * r, (row + 0.5) * r};
      n += 1.0;
      x += p.x;
      y += p.y;
      xx += p.x * p.x;
      yy += p.y * p.y;
    }
  }
  if (n == 0.0) return {};
  PlaceSpread spread;
  spread.mean = {x / n, y / n, 0.0};
  spread.stddev = {std::sqrt(std::max(r * r, xx / n - x * x / (n * n))),
                   std::sqrt(std::max(r * r, yy / n - y * y / (n * n))), hyselam::kPi};
  return spread;
}

}  // namespace selovis

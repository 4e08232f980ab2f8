#include "hyselam_objects/language/link_places.hpp"

#include <algorithm>
#include <vector>

#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topological_map/place_code.hpp"

namespace hyselam_objects {
namespace {

/// What was told of "SS05", before it had a name, is of the name that it has now.
void takeNames(ObjectMap& map, const hyselam_topo::AugmentedTopologicalMap& topology) {
  for (ObjectPlace& place : map.places) {
    const hyselam_topo::Place* known = topology.findPlace(place.topological);
    const bool named = known != nullptr && place.name == codeOf(*known) &&
                       std::any_of(known->words.begin(), known->words.end(),
                                   [](const auto& word) { return word.confirmed; });
    if (!named) continue;
    const std::string name = nameOf(*known);
    const auto other = std::find_if(map.places.begin(), map.places.end(),
                                    [&](const ObjectPlace& each) { return each.name == name; });
    if (other == map.places.end()) {
      place.name = name;
      continue;
    }
    std::vector<ObjectRelation> moved;
    for (const ObjectRelation& each : map.relations) {
      if (each.place == place.id) moved.push_back(each);
    }
    auto& all = map.relations;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const ObjectRelation& each) { return each.place == place.id; }),
              all.end());
    for (ObjectRelation& each : moved) {
      each.place = other->id;
      map.relate(each);
    }
  }
}

}  // namespace

hyselam_topo::PlaceNames shippedPlaceNames() {
  std::vector<hyselam_topo::Grammar> grammars;
  for (const std::string& language : hyselam_topo::Grammar::shippedLanguages()) {
    grammars.push_back(hyselam_topo::Grammar::shipped(language));
  }
  return hyselam_topo::PlaceNames(std::move(grammars));
}

std::size_t linkPlaces(ObjectMap& map, const hyselam_topo::AugmentedTopologicalMap& topology,
                       const hyselam_topo::PlaceNames& names) {
  std::vector<std::vector<std::string>> words;
  for (const hyselam_topo::Place& place : topology.places) {
    words.emplace_back();
    for (const hyselam_topo::PlaceTerm& word : place.words) words.back().push_back(word.text);
    if (words.back().empty()) words.back().push_back(nameOf(place));
    words.back().push_back(codeOf(place));
  }
  std::size_t left = 0;
  for (ObjectPlace& place : map.places) {
    if (place.topological != 0 && topology.findPlace(place.topological) != nullptr) continue;
    const std::vector<std::size_t> found = names.find(place.name, words);
    place.topological = found.size() == 1 ? topology.places[found.front()].id : 0;
    left += place.topological == 0;
  }
  takeNames(map, topology);
  if (!topology.grid) return left;
  for (std::size_t i = 0; i < map.objects.size(); ++i) {
    const ObjectInstance& object = map.objects[i];
    if (!object.pose || map.placeOf(object.id) != 0) continue;
    const Point3& p = object.pose->position;
    const Id topological = topology.grid->placeOf(topology.grid->geometry.cellAt({p.x, p.y}));
    const hyselam_topo::Place* place = topology.findPlace(topological);
    if (place == nullptr) continue;
    Id id = 0;
    for (const ObjectPlace& each : map.places) {
      if (each.topological == topological) id = each.id;
    }
    ObjectRelation at;
    at.object = object.id;
    at.place = id != 0 ? id : map.addPlace(nameOf(*place), topological);
    if (place->centre) {
      at.vector = Point3{p.x - place->centre->x, p.y - place->centre->y, p.z - place->centre->z};
    }
    map.relate(at);
  }
  return left;
}

}  // namespace hyselam_objects

#include "hyselam_objects/language/link_places.hpp"

#include "hyselam_language/grammar/topo_parser.hpp"

namespace hyselam_objects {

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
  }
  std::size_t left = 0;
  for (ObjectPlace& place : map.places) {
    if (place.topological != 0 && topology.findPlace(place.topological) != nullptr) continue;
    const std::vector<std::size_t> found = names.find(place.name, words);
    place.topological = found.size() == 1 ? topology.places[found.front()].id : 0;
    left += place.topological == 0;
  }
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

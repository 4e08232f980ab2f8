#include <sstream>
#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_objects/fill_map.hpp"
#include "hyselam_objects/object_dictionary.hpp"
#include "hyselam_objects/object_map.hpp"
#include "hyselam_objects/object_relations.hpp"

namespace hyselam_objects {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

/// Text, a line at a time, into an object map that stays sound and comes back from XML as it was.
void objectText(const std::uint8_t* data, std::size_t size) {
  static const ObjectParser kParser = ObjectParser::shipped();
  std::istringstream text(textOf(data, size));
  ObjectMap map;
  FillMap fill(&kParser, &map);
  if (size > 0 && data[0] % 2 == 0) fill.setPlace("studio");
  int lines = 0;
  for (std::string line; ++lines <= 20 && std::getline(text, line);) {
    for (const ObjectReply& reply : fill.say(line)) {
      require(!reply.text.empty());
      // A later sentence of the same line may have had some of them forgotten.
      for (const Id id : reply.objects) require(id > 0 && id < map.next_object_id);
      for (const Id id : reply.places) require(id > 0 && id < map.next_place_id);
    }
    checkMap(map, "told");
  }
  require(objectMapFromXml(toXml(map)) == map);
  fill.unknownKinds(ObjectDictionary{});
}

/// XML of an object map: refused, or read and written to the same again.
void objectMapXml(const std::uint8_t* data, std::size_t size) {
  const std::string text = textOf(data, size);
  ObjectMap map;
  try {
    map = objectMapFromXml(text, "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  checkMap(map, "read");
  require(objectMapFromXml(toXml(map)) == map);
  for (const ObjectInstance& object : map.objects) {
    const double share = movability(map, object.id);
    require(share >= 0.0 && share <= 1.0);
  }
  tellObjects(map);
  updateRelations(&map);
  checkMap(map, "related");
}

/// XML of an object dictionary: the same, and it can be merged and used.
void objectDictionaryXml(const std::uint8_t* data, std::size_t size) {
  const std::string text = textOf(data, size);
  ObjectDictionary dictionary;
  try {
    dictionary = dictionaryFromXml(text, "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  require(dictionaryFromXml(toXml(dictionary)) == dictionary);
  require(merged(dictionary, dictionary).objects.size() == dictionary.objects.size());
}

}  // namespace
}  // namespace hyselam_objects

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_objects;  // NOLINT: its own targets
  return {{"objectText", objectText},
          {"objectMapXml", objectMapXml},
          {"objectDictionaryXml", objectDictionaryXml}};
}

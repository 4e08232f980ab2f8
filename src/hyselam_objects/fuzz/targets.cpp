#include <cmath>
#include <sstream>
#include <string>

#include "../src/language/object_words.hpp"
#include "../src/segmentation/relation_model.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_objects/language/fill_map.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/mapping/object_relations.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"
#include "hyselam_objects/segmentation/organize_cloud.hpp"

namespace hyselam_objects {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

/// Text, a line at a time, into an object map that stays sound and comes back from XML as it was.
void objectText(const std::uint8_t* data, std::size_t size) {
  static const ObjectParser kParser = ObjectParser::shipped();
  std::istringstream text(textOf(data, size));
  ObjectMap map;
  FillMap fill(kParser, map);
  if (size > 0 && data[0] % 2 == 0) fill.setRobotPlace("studio");
  int lines = 0;
  for (std::string line; ++lines <= 20 && std::getline(text, line);) {
    for (const ObjectReply& reply : fill.process(line)) {
      require(!reply.text.empty());
      // A later sentence of the same line may have had some of them forgotten.
      for (const Id id : reply.objects) require(id > 0 && id < map.next_object_id);
      for (const Id id : reply.places) require(id > 0 && id < map.next_place_id);
    }
    checkMap(map, "described");
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
  summaryLines(map);
  updateRelations(map);
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

/// A list of words for objects: refused, or a grammar can be made of it.
void objectWords(const std::uint8_t* data, std::size_t size) {
  try {
    const ObjectWords words = ObjectWords::fromYaml({"fuzz", textOf(data, size)});
    hyselam_topo::Grammar::fromYaml({words.grammar()});
    for (const std::string& noun : words.nouns) words.singular(noun);
  } catch (const hyselam::InputError&) {
  }
}

/// The PCD file of a cloud: refused, or points that are numbers or all none, made an image if they
/// are one, and written and read as the same.
void objectCloud(const std::uint8_t* data, std::size_t size) {
  static const hyselam::testing::FuzzFolder folder;
  CloudFile file;
  try {
    file = readPcd(folder.put("cloud.pcd", textOf(data, size)));
  } catch (const hyselam::InputError&) {
    return;
  }
  const std::size_t points = file.cloud.points.size();
  require(points == file.cloud.size() && points > 0);
  require(file.cloud.colors.empty() || file.cloud.colors.size() == points);
  require(file.labels.empty() || file.labels.size() == points);
  for (const Point& p : file.cloud.points) {
    require(p.allFinite() || (std::isnan(p.x()) && std::isnan(p.y()) && std::isnan(p.z())));
  }
  if (const auto view = organizeCloud(file.cloud)) {
    require(view->pixel_of.size() == points);
    for (const std::int32_t pixel : view->pixel_of) {
      require(pixel < static_cast<std::int64_t>(view->cloud.size()));
    }
  }
  file.labels.resize(points);
  const std::string again = folder.path("again.pcd");
  writePcd(again, file.cloud, file.labels);
  const CloudFile same = readPcd(again);
  require(same.labels == file.labels && same.cloud.colors == file.cloud.colors &&
          same.cloud.width == file.cloud.width && same.cloud.height == file.cloud.height);
}

/// The file of the odds of patches: refused, or weights whose text is the same again, with which
/// the odds of any relation are found.
void patchRelations(const std::uint8_t* data, std::size_t size) {
  const std::string text = hyselam::testing::withRightChecksum(textOf(data, size));
  try {
    const auto model = hyselam::testing::modelWrittenBack<RelationModel>(text);
    PatchRelation relation;
    relation.convex = relation.hidden = 5;
    require(std::abs(model.oddsOfOneObject(relation, true)) <= 16.0);
  } catch (const hyselam::InputError&) {
    return;
  }
}

}  // namespace
}  // namespace hyselam_objects

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_objects;  // NOLINT: its own targets
  return {{"objectText", objectText},
          {"objectMapXml", objectMapXml},
          {"objectDictionaryXml", objectDictionaryXml},
          {"objectWords", objectWords},
          {"objectCloud", objectCloud},
          {"patchRelations", patchRelations}};
}

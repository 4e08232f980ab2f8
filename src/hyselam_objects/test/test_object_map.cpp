// Value types and files of dictionary and map.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_objects/language/link_places.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"

using namespace hyselam_objects;  // NOLINT: a test, not a header
using hyselam::InputError;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;

namespace {

ObjectMap sample() {
  ObjectMap map;
  const Id kitchen = map.addPlace("kitchen", 7);
  const Id table = map.addObject("table"), cup = map.addObject("cup");
  ObjectInstance& object = *map.find(cup);
  object.properties = {{"colour", "red <&\"> \xc3\xa4"}};
  object.pose =
      ObjectPose{{1.0, 2.0, 0.8}, {0.1, 0.1, 0.12}, 0.3, {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4}};
  object.outline = outlineOf(GroundBox{1.0, 2.0, 0.1, 0.1, 0.3});
  object.descriptor = {0.1f, 0.2f};
  object.detections = 4;
  object.last_seen = 1700000000.25;
  object.existence = 0.9;
  object.history = {{1.0, 2.0, {0.0, 0.0, 0.0}}, {3.0, 4.0, {1.0, 2.0, 0.8}}};
  ObjectRelation at;
  at.object = cup;
  at.place = kitchen;
  map.relate(at);
  at.object = table;
  map.relate(at);
  ObjectRelation on;
  on.object = cup;
  on.word = RelationWord::kOn;
  on.other = table;
  on.vector = Point3{0.1, 0.2, 0.4};
  on.movability = 0.75;
  map.relate(on);
  return map;
}

ObjectDictionary sampleDictionary() {
  ObjectDictionary dictionary;
  GenericObject cup;
  cup.name = "cup";
  cup.synonyms = {"mug"};
  cup.shape.size = {0.1, 0.08, 0.12};
  cup.texture = {0.5f, 0.25f};
  cup.features = {{"weight", 0.3}};
  cup.classifier = {"test", {{1.0f, 2.0f}, {3.0f, 4.5f}}, 0.4};
  dictionary.put(cup);
  GenericObject book;
  book.name = "book";
  dictionary.put(book);
  return dictionary;
}

}  // namespace

TEST(ObjectMap, ReadsBackWhatItWrites) {
  const ObjectMap map = sample();
  EXPECT_TRUE(objectMapFromXml(toXml(map)) == map);
  EXPECT_EQ(toXml(objectMapFromXml(toXml(map))), toXml(map));
  const ObjectDictionary dictionary = sampleDictionary();
  EXPECT_TRUE(dictionaryFromXml(toXml(dictionary)) == dictionary);
}

// As files of version 1 are: without outlines.
TEST(ObjectMap, ReadsOlderFiles) {
  ObjectMap map = sample();
  for (ObjectInstance& object : map.objects) object.outline.clear();
  std::string text = toXml(map);
  const std::size_t at = text.find("version=\"2\"");
  ASSERT_NE(at, std::string::npos);
  text[at + 9] = '1';
  EXPECT_TRUE(objectMapFromXml(text) == map);
}

TEST(ObjectMap, FollowsItsSchema) {
  if (std::system("xmllint --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no xmllint here";
  TemporaryDirectory directory;
  saveXml(directory / "map.xml", sample());
  saveXml(directory / "dictionary.xml", sampleDictionary());
  for (const auto& [file, schema] : {std::pair<const char*, const char*>{"map.xml", "object_map"},
                                     {"dictionary.xml", "object_dictionary"}}) {
    const std::string command = std::string("xmllint --noout --schema '") + HYSELAM_PACKAGE_DIR +
                                "/xsd/" + schema + ".xsd' '" + (directory / file) + "' 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << file;
  }
}

TEST(ObjectMap, RemovesAnObjectWithItsRelations) {
  ObjectMap map = sample();
  map.remove(1);
  EXPECT_EQ(map.objects.size(), 1u);
  EXPECT_EQ(map.relations.size(), 1u);
  checkMap(map, "map");
}

TEST(ObjectMap, RefusesInvalidMaps) {
  const auto refused = [](const std::function<void(ObjectMap&)>& change,
                          const std::string& reason) {
    ObjectMap map = sample();
    change(map);
    EXPECT_NE(messageOf<InputError>([&] { toXml(map, "m.xml"); }).find(reason), std::string::npos)
        << reason;
  };
  refused([](ObjectMap& m) { m.objects[0].id = 0; }, "its id is 0");
  refused([](ObjectMap& m) { m.objects[1].id = 1; }, "stands twice");
  refused([](ObjectMap& m) { m.next_object_id = 2; }, "not below the next one");
  refused([](ObjectMap& m) { m.objects[0].kind = ""; }, "no word");
  refused([](ObjectMap& m) { m.objects[0].kind = "a\nb"; }, "no word");
  refused([](ObjectMap& m) { m.objects[1].existence = 1.5; }, "existence");
  refused([](ObjectMap& m) { m.objects[1].existence = NAN; }, "existence");
  refused([](ObjectMap& m) { m.objects[1].pose->position.x = INFINITY; }, "not finite");
  refused([](ObjectMap& m) { m.objects[1].pose->size[1] = -1.0; }, "size");
  refused([](ObjectMap& m) { m.objects[1].pose->covariance[4] = -1.0; }, "covariance");
  refused([](ObjectMap& m) { m.objects[1].outline.pop_back(); }, "72 directions");
  refused([](ObjectMap& m) { m.objects[1].outline[3] = NAN; }, "not finite");
  refused([](ObjectMap& m) { m.objects[1].history[0].until = 0.0; }, "stay");
  refused([](ObjectMap& m) { m.relations[0].object = 9; }, "no such object");
  refused([](ObjectMap& m) { m.relations.back().other = 2; }, "is itself");
  refused([](ObjectMap& m) { m.relations.back().movability = 2.0; }, "movability");
  refused([](ObjectMap& m) { m.relations[0].place = 9; }, "no such place");
  refused([](ObjectMap& m) { m.relations[0].word = RelationWord::kOn; }, "only at, near");
}

TEST(ObjectMap, RefusesHostileFiles) {
  const std::string good = toXml(sample());
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  std::string deep = good.substr(0, good.find("<place"));
  for (int i = 0; i < 200; ++i) deep += "<a>";
  for (const std::string& text :
       {std::string(), std::string("no XML"), good.substr(0, good.size() / 2), deep,
        replaced("version=\"2\"", "version=\"3\""), replaced("<outline>", "<outline>1 "),
        replaced("object_map:1", "object_map:9"),
        replaced("<place", "<!DOCTYPE x [<!ENTITY a \"b\">]><place"),
        replaced("told=\"false\"", "told=\"perhaps\""), replaced("seen=\"0\"", "seen=\"-1\""),
        replaced("word=\"at\"", "word=\"beneath\""), replaced("id=\"1\"", "id=\"1e99\""),
        replaced("id=\"1\"", "id=\"nan\""), replaced("<size>", "<size>1 "),
        replaced("kind=", "unknown=\"1\" kind="), replaced("kind=\"table\"", "")}) {
    EXPECT_NE(messageOf<InputError>([&] { objectMapFromXml(text, "m.xml"); }).find("m.xml"),
              std::string::npos)
        << text.substr(0, 200);
  }
  EXPECT_NE(messageOf<InputError>([] { loadObjectMap("/does/not/exist.xml"); }), "");
  EXPECT_NE(messageOf<InputError>([&] { dictionaryFromXml(good, "d.xml"); }), "");
}

TEST(ObjectMap, SurvivesDamagedFiles) {
  const std::string good = toXml(sample()), words = toXml(sampleDictionary());
  std::uint32_t state = 3;
  for (int i = 0; i < 1000; ++i) {
    std::string text = i % 2 == 0 ? good : words;
    for (int k = 0; k < 1 + i % 4; ++k) {
      state = state * 1664525u + 1013904223u;
      text[(state >> 8) % text.size()] = static_cast<char>(state >> 21);
    }
    try {
      if (i % 2 == 0) {
        checkMap(objectMapFromXml(text), "map");
      } else {
        checkDictionary(dictionaryFromXml(text), "dictionary");
      }
    } catch (const InputError&) {
    }
  }
}

TEST(ObjectMap, KeepsLastSaveWhenKilledWhileSaving) {
  TemporaryDirectory directory;
  const std::string path = directory / "map.xml";
  saveXml(path, sample());
  for (int round = 0; round < 5; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      ObjectMap map = sample();
      for (int i = 0;; ++i) {
        map.addObject("cup " + std::to_string(i % 300));
        if (map.objects.size() > 400) map = sample();
        saveXml(path, map);
      }
    }
    ::usleep(20000 + 7000 * static_cast<unsigned>(round));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    const ObjectMap map = loadObjectMap(path);
    EXPECT_GE(map.objects.size(), 2u);
  }
}

TEST(ObjectDictionary, MergesTheDictionariesOfTwoRobots) {
  const ObjectDictionary a = sampleDictionary();
  ObjectDictionary b;
  GenericObject cup = *a.find("mug");
  cup.synonyms = {"beaker"};
  cup.classifier.views = {{1.0f, 2.0f}, {5.0f, 6.0f}};
  b.put(cup);
  GenericObject pen;
  pen.name = "pen";
  b.put(pen);
  const ObjectDictionary both = merged(a, b);
  checkDictionary(both, "both");
  EXPECT_EQ(both.objects.size(), 3u);
  EXPECT_EQ(both.find("beaker")->classifier.views.size(), 3u);
  EXPECT_EQ(merged(both, b).find("cup")->classifier.views.size(), 3u);
}

TEST(ObjectDictionary, RefusesInvalidDictionaries) {
  const auto refused = [](const std::function<void(ObjectDictionary&)>& change) {
    ObjectDictionary dictionary = sampleDictionary();
    change(dictionary);
    EXPECT_THROW(checkDictionary(dictionary, "d"), InputError);
  };
  refused([](auto& d) { d.objects[1].synonyms = {"book"}; });
  refused([](auto& d) { d.objects[0].name = ""; });
  refused([](auto& d) { d.objects[0].name = "zoo"; });
  refused([](auto& d) { d.objects[1].classifier.views[0] = {}; });
  refused([](auto& d) { d.objects[1].classifier.views[0] = {NAN, 1.0f}; });
  refused([](auto& d) { d.objects[1].classifier.max_distance = -1.0; });
  refused([](auto& d) { d.objects[1].shape.size[0] = -1.0; });
}

TEST(LinkPlaces, LinksNamesToPlacesOfTheTopologicalMap) {
  hyselam_topo::AugmentedTopologicalMap topology;
  for (const char* name : {"the kitchen", "room I-109", "lab"}) {
    hyselam_topo::Place place;
    place.id = topology.next_place_id++;
    place.words.push_back({name, true});
    topology.places.push_back(place);
  }
  hyselam_topo::PlaceGrid grid;
  grid.geometry.width = grid.geometry.height = 10;
  grid.geometry.resolution = 1.0;
  grid.labels.assign(100, 1);
  grid.places = {3};
  topology.grid = grid;
  ObjectMap map;
  map.addPlace("Kitchen");
  map.addPlace("I-109");
  map.addPlace("attic");
  const Id seen = map.addObject("cup");
  map.find(seen)->pose = ObjectPose{{2.0, 3.0, 1.0}, {0.1, 0.1, 0.1}, 0.0, {}};
  EXPECT_EQ(linkPlaces(map, topology, shippedPlaceNames()), 1u);
  EXPECT_EQ(map.places[0].topological, 1u);
  EXPECT_EQ(map.places[1].topological, 2u);
  EXPECT_EQ(map.places[2].topological, 0u);
  EXPECT_EQ(map.findPlace(map.placeOf(seen))->topological, 3u);
  checkMap(map, "map");
}

#include <gtest/gtest.h>

#include <limits>
#include <locale>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/xml_testing.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/testing/random_maps.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

namespace hyselam_topo {
namespace {

using hyselam::testing::expectError;
using hyselam::testing::messageOf;
using hyselam::testing::replaced;
using hyselam::testing::TemporaryDirectory;

AugmentedTopologicalMap twoRooms() {
  AugmentedTopologicalMap map;
  map.stamp = 12.5;
  Place kitchen;
  kitchen.id = 1;
  kitchen.words = {{"kitchen", true}};
  kitchen.area = 12.0;
  kitchen.centre = Point3{2.0, 1.5, 0.0};
  kitchen.outline = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  kitchen.walls = {straightWall({0, 0}, {4, 0})};
  kitchen.walls[0].id = 1;
  kitchen.walls[0].position_covariance = Covariance3{0.01, 0, 0, 0, 0.01, 0, 0, 0, 0};
  Place corridor;
  corridor.id = 2;
  corridor.kind = PlaceKind::kCorridor;
  map.places = {kitchen, corridor};
  Edge edge;
  edge.a = 1;
  edge.b = 2;
  edge.doors = {doorBetween({4, 1}, {4, 2})};
  edge.doors[0].id = 1;
  map.edges = {edge};
  PlaceGrid grid;
  grid.geometry.width = 3;
  grid.geometry.height = 2;
  grid.geometry.resolution = 1.0;
  grid.labels = {1, 1, 2, 0, 1, 2};
  grid.places = {1, 2};
  map.grid = grid;
  normalize(map);
  return map;
}

/// The error of reading the map of two rooms with one thing changed.
std::string errorWith(const std::string& from, const std::string& to) {
  const std::string text = replaced(toXml(twoRooms()), from, to);
  return messageOf<hyselam::InputError>([&] { fromXml(text, "m.xml"); });
}

TEST(Xml, MapRoundTrips) {
  const AugmentedTopologicalMap map = twoRooms();
  EXPECT_EQ(fromXml(toXml(map)), map);
}

TEST(Xml, RandomMapsRoundTrip) {
  hyselam::testing::expectReadBack(
      200, [](unsigned seed) { return testing::RandomMaps(seed).map(); },
      [](const std::string& text) { return fromXml(text); });
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
RC_GTEST_PROP(Xml, EveryMapComesBackAsItWas, (unsigned seed)) {
  const AugmentedTopologicalMap map = testing::RandomMaps(seed).map();
  RC_ASSERT(fromXml(toXml(map)) == map);
}

// Whatever a file says: it is read or refused.
RC_GTEST_PROP(Xml, DamagedFilesNeverCrash, (unsigned seed)) {
  try {
    checkMap(fromXml(hyselam::testing::damaged(toXml(testing::RandomMaps(seed).map()), seed)),
             "damaged");
  } catch (const hyselam::InputError&) {
  }
}
#endif

/// Numbers as a German writes them.
struct German : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Xml, TextDoesNotDependOnTheLocale) {
  AugmentedTopologicalMap map = twoRooms();
  map.stamp = 1234567.25;
  const std::string text = toXml(map);
  const std::locale old = std::locale::global(std::locale(std::locale::classic(), new German));
  const std::string in_german = toXml(map);
  const AugmentedTopologicalMap read = fromXml(text);
  std::locale::global(old);
  EXPECT_EQ(in_german, text);
  EXPECT_EQ(read, map);
}

TEST(Xml, WhatIsWrittenFollowsTheSchema) {
  if (!hyselam::testing::haveXmllint()) GTEST_SKIP() << "no xmllint here";
  const auto valid = [](const std::string& text) {
    return hyselam::testing::follows("topological_map.xsd", text);
  };
  const std::string text = toXml(twoRooms());
  EXPECT_TRUE(valid(text));
  EXPECT_FALSE(valid(replaced(text, "existence=\"1\"", "existence=\"0.7\"")));
  EXPECT_FALSE(valid(replaced(text, "<edge a=\"1\" b=\"2\">", "<edge a=\"1\" b=\"3\">")));
  EXPECT_FALSE(valid(replaced(text, "length=\"4\"", "")));
  for (unsigned seed = 0; seed < 20; ++seed) {
    AugmentedTopologicalMap map = testing::RandomMaps(seed).map();
    map.extras.attributes = {{"xmlns:ext", "urn:ext"}, {"ext:note", "1"}};
    EXPECT_TRUE(valid(toXml(map))) << toXml(map);
  }
}

TEST(Xml, VersionOneIsStillRead) {
  const AugmentedTopologicalMap map = loadXml(HYSELAM_PACKAGE_DIR "/test/data/version_1.xml");
  EXPECT_EQ(map, twoRooms()) << toXml(twoRooms());
}

TEST(Xml, UnknownPartsAreKept) {
  std::string text = toXml(twoRooms());
  text = replaced(text, "<place id=\"1\"", "<place colour=\"red\" id=\"1\"");
  text = replaced(text, "<word text=\"kitchen\"",
                  "<story mood=\"grim\">once <b>upon</b> a time</story>"
                  "<word text=\"kitchen\"");
  const AugmentedTopologicalMap map = fromXml(text);
  EXPECT_EQ(map.places[0].words, twoRooms().places[0].words);
  const Extras& extras = map.places[0].extras;
  ASSERT_EQ(extras.attributes.size(), 1u);
  EXPECT_EQ(extras.attributes[0], std::make_pair(std::string("colour"), std::string("red")));
  ASSERT_EQ(extras.elements.size(), 1u);
  EXPECT_EQ(extras.elements[0], "<story mood=\"grim\">once <b>upon</b> a time</story>");
  EXPECT_EQ(fromXml(toXml(map)), map);
}

TEST(Xml, ExtrasThatAreNoXmlAreRefused) {
  for (const char* bad : {"", "text", "<a>", "<a/><b/>", "<a></b>"}) {
    AugmentedTopologicalMap map = twoRooms();
    map.places[0].extras.elements = {bad};
    EXPECT_THROW(toXml(map), hyselam::InputError) << bad;
  }
  AugmentedTopologicalMap map = twoRooms();
  map.extras.attributes = {{"not a name", "1"}};
  EXPECT_THROW(toXml(map), hyselam::InputError);
}

TEST(Xml, RefusesOtherFormats) {
  const auto error = [](const std::string& text) {
    return messageOf<hyselam::InputError>([&] { fromXml(text, "m.xml"); });
  };
  expectError(error(""), {"m.xml", "no XML"});
  expectError(error("kitchen"), {"m.xml", "no XML"});
  expectError(error("<a>"), {"m.xml", "line 1", "no XML"});
  expectError(error("<a/><b/>"), {"m.xml", "one outermost element"});
  expectError(error("<svg/>"), {"m.xml", "line 1, <svg>", "no topological map"});
  expectError(error("<topological_map xmlns=\"urn:other\"/>"), {"no topological map"});
  expectError(error(std::string("\0<a/>", 5)), {"not UTF-8"});
  expectError(error("<a x=\"\xff\"/>"), {"not UTF-8"});
  expectError(errorWith("version=\"1\" frame", "version=\"2\" frame"),
              {"has version 2, this program reads 1; it was written by a newer HySeLAM"});
}

TEST(Xml, EntitiesAreRefused) {
  expectError(errorWith("<topological_map",
                        "<!DOCTYPE m [<!ENTITY a \"&b;&b;\"><!ENTITY b \"ha\">]><topological_map"),
              {"m.xml", "entities are not allowed"});
  expectError(
      errorWith("<topological_map", "<!DOCTYPE m SYSTEM \"file:///etc/passwd\"><topological_map"),
      {"m.xml", "entities are not allowed"});
}

TEST(Xml, TooMuchIsRefused) {
  const std::string text = toXml(twoRooms());
  const auto error = [&](const std::string& t, const MapXmlLimits& limits) {
    return messageOf<hyselam::InputError>([&] { fromXml(t, "m.xml", limits); });
  };
  MapXmlLimits limits;
  limits.max_bytes = text.size() - 1;
  expectError(error(text, limits), {"m.xml", "bytes, more than"});
  limits = {};
  limits.max_elements = 5;
  expectError(error(text, limits), {"more than 5 elements"});
  limits = {};
  limits.max_attributes = 5;
  expectError(error(text, limits), {"more than 5 attributes"});
  limits = {};
  limits.max_grid_cells = 5;
  expectError(error(text, limits), {"line", "<grid>", "6 values, more than 5"});

  expectError(error(replaced(text, "<place", hyselam::testing::nested(40) + "<place"), {}),
              {"nested too deeply"});
  std::string deeper;
  for (int i = 0; i < 100000; ++i) deeper += "<a>";
  EXPECT_NE(error(replaced(text, "<place", deeper + "<place"), {}), "");

  const TemporaryDirectory dir;
  hyselam::testing::writeFile(dir / "m.xml", text);
  limits = {};
  limits.max_bytes = 100;
  EXPECT_NE(messageOf<hyselam::InputError>([&] { loadXml(dir / "m.xml", limits); }), "");
}

TEST(Xml, DataThatDoNotFillTheGridAreRefused) {
  // A bomb: the sizes say 4e18 cells.
  expectError(errorWith("width=\"3\" height=\"2\"", "width=\"2000000000\" height=\"2000000000\""),
              {"<grid>", "values, more than"});
  expectError(errorWith("width=\"3\" height=\"2\"", "width=\"8000\" height=\"8000\""),
              {"<labels>", "too short"});
  expectError(errorWith("width=\"3\"", "width=\"4\""), {"<labels>", "too short"});
  expectError(errorWith("width=\"3\"", "width=\"2\""), {"<labels>", "more packed data"});
  expectError(errorWith("width=\"3\"", "width=\"0\""), {"<grid>", "no rows or columns"});
  expectError(errorWith("width=\"3\"", "width=\"2.5\""), {"<grid>", "no whole number"});
  const std::string begin = "encoding=\"zlib+base64\">";
  expectError(errorWith(begin, begin + "!!!!"), {"<labels>", "no base64"});
  expectError(errorWith(begin, begin + "A"), {"<labels>", "cut off"});
  expectError(errorWith(begin, begin + "AAAA"), {"<labels>", "damaged"});
  expectError(errorWith("zlib+base64", "lzma"), {"<labels>", "encoding 'lzma' is not known"});
  expectError(errorWith("<places>1 2<", "<places>1 3<"), {"grid", "no place 3"});
  expectError(errorWith("<places>1 2<", "<places>1<"), {"grid", "label 2 stands for no place"});
  expectError(errorWith("<places>1 2<", "<places>1 -2<"), {"<places>", "ids of places"});
}

TEST(Xml, NumbersThatAreNoneAreRefused) {
  for (const char* bad : {"nan", "inf", "-inf", "1e999", "0x10", "1,5", "", "four", "4 "}) {
    expectError(errorWith("length=\"4\"", "length=\"" + std::string(bad) + "\""),
                {"m.xml", "<wall>", "'length'", "no finite number"});
  }
  expectError(errorWith("0.01 0 0 0 0.01 0 0 0 0", "0.01 0 0 0 0.01 0 0 0 nan"),
              {"<covariance>", "'nan' is no finite number"});
  expectError(errorWith("0.01 0 0 0 0.01 0 0 0 0", "0.01 0 0 0 0.01 0 0 0"),
              {"<covariance>", "9 numbers, not 8"});
  expectError(errorWith("0.01 0 0 0 0.01 0 0 0 0", "0.01 0 1 0 0.01 0 0 0 0"),
              {"place 1, wall 1", "not symmetric"});
  expectError(errorWith("0.01 0 0 0 0.01 0 0 0 0", "-0.01 0 0 0 0.01 0 0 0 0"),
              {"place 1, wall 1", "variance is negative"});
  expectError(errorWith("length=\"4\"", "length=\"-4\""), {"place 1, wall 1", "negative"});
  expectError(errorWith("<normal x=\"0\" y=\"1\"", "<normal x=\"0\" y=\"2\""),
              {"place 1, wall 1", "not of length 1"});
  expectError(errorWith("curvature=\"0\"", "curvature=\"2\""), {"wall 1", "more than a circle"});
  expectError(errorWith("<outline>0 0", "<outline>0"), {"<outline>", "odd"});
  expectError(errorWith("<outline>0 0", "<outline>1e300 0"), {"place 1", "10000 km"});
}

TEST(Xml, IdsMustBeUniqueAndMeanSomething) {
  expectError(errorWith("<place id=\"2\"", "<place id=\"1\""), {"place 1", "two places"});
  expectError(errorWith("<place id=\"2\"", "<place id=\"0\""), {"<place>", "no id"});
  expectError(errorWith("<place id=\"2\"", "<place id=\"-2\""), {"<place>", "no id"});
  expectError(errorWith("<place id=\"2\"", "<place id=\"4294967296\""), {"<place>", "no id"});
  expectError(errorWith("<place id=\"2\"", "<place id=\"9\""), {"place 9", "next place id"});
  expectError(errorWith("a=\"1\" b=\"2\"", "a=\"1\" b=\"3\""), {"edge 1-3", "no place 3"});
  expectError(errorWith("a=\"1\" b=\"2\"", "a=\"2\" b=\"1\""), {"edge 2-1", "come first"});
  expectError(errorWith("a=\"1\" b=\"2\"", "a=\"1\" b=\"1\""), {"edge 1-1", "with itself"});
  expectError(errorWith("<edge", "<edge a=\"1\" b=\"2\"/><edge"), {"edge 1-2", "twice"});
}

TEST(Xml, MissingAndRepeatedPartsAreRefused) {
  expectError(errorWith("length=\"4\"", ""), {"<wall>", "'length' is missing"});
  expectError(errorWith("length=\"4\"", "length=\"4\" length=\"4\""), {"m.xml"});
  expectError(errorWith("<origin x=\"0\" y=\"0\" theta=\"0\"/>", ""),
              {"<grid>", "<origin> is missing"});
  expectError(errorWith("<normal x=\"0\" y=\"1\" z=\"0\"/>",
                        "<normal x=\"0\" y=\"1\" z=\"0\"/><normal x=\"0\" y=\"1\" z=\"0\"/>"),
              {"<normal>", "stands twice"});
  expectError(errorWith("confirmed=\"true\"", "confirmed=\"maybe\""), {"<word>", "true or false"});
  expectError(errorWith("text=\"kitchen\"", "text=\"\""), {"place 1", "a word is empty"});
  expectError(errorWith("text=\"kitchen\"", "text=\"a&#7;b\""), {"control character"});
  expectError(errorWith("kind=\"room\"", "kind=\"hut\""), {"<place>", "room, corridor or virtual"});
  expectError(errorWith("existence=\"1\"", "existence=\"0.7\""), {"<wall>", "0, 0.5 or 1"});
  expectError(errorWith("<place id=\"2\"", "stray<place id=\"2\""), {"only elements may"});
  expectError(errorWith("<origin", "<oranges/><origin"), {"<oranges>", "not known here"});
}

TEST(Xml, FilesAreReplacedAtOnce) {
  const TemporaryDirectory dir;
  saveXml(dir / "m.xml", twoRooms());
  EXPECT_EQ(loadXml(dir / "m.xml"), twoRooms());
  const std::string before = hyselam::testing::fileBytes(dir / "m.xml");
  AugmentedTopologicalMap bad = twoRooms();
  bad.places[0].area = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(saveXml(dir / "m.xml", bad), hyselam::InputError);
  EXPECT_EQ(hyselam::testing::fileBytes(dir / "m.xml"), before);
  EXPECT_EQ(dir.fileCount(), 1u);
  EXPECT_THROW(saveXml(dir / "none/m.xml", twoRooms()), hyselam::InputError);
  EXPECT_THROW(loadXml(dir / "none.xml"), hyselam::InputError);
}

TEST(GraphMl, GivesNodesAndEdges) {
  const std::string text = toGraphMl(twoRooms());
  expectError(text, {"<node id=\"p1\">", "<data key=\"label\">kitchen</data>",
                     "<data key=\"label\">corridor 2</data>", "<edge source=\"p1\" target=\"p2\">",
                     "<data key=\"width\">1</data>"});
}

}  // namespace
}  // namespace hyselam_topo

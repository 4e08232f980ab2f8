#include <gtest/gtest.h>

#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/xml_testing.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "random_descriptions.hpp"
#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

namespace hyselam_topo {
namespace {

using hyselam::testing::expectError;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;

DescribedBuilding flat() {
  DescribedBuilding building;
  building.places.resize(3);
  building.places[0].id = 1;
  building.places[0].name = "corridor";
  building.places[0].kind = PlaceKind::kCorridor;
  building.places[1].id = 2;
  building.places[1].name = "room A";
  building.places[1].aliases = {"John's office"};
  building.places[1].length = 6.0;
  building.places[1].width = 8.0;
  building.places[1].area = 48.0;
  building.places[2].id = 4;
  building.places[2].name = "house";
  building.places[2].parts = 6;
  building.connections = {{1, 2, Side::kLeft, 0}, {1, 4, Side::kUnknown, 3}};
  building.relations = {{RelationKind::kBetween, 2, 1, 4}, {RelationKind::kNextTo, 1, 2, 0}};
  building.robot_place = 1;
  building.place_count = 3;
  return building;
}

std::string errorOf(const std::string& text, const hyselam::XmlLimits& limits = {}) {
  return messageOf<hyselam::InputError>([&] { descriptionFromXml(text, "h.xml", limits); });
}

/// The error of reading the flat with one thing changed.
std::string errorWith(const std::string& from, const std::string& to) {
  return errorOf(hyselam::testing::replaced(toXml(flat()), from, to));
}

TEST(DescriptionXml, DescriptionsAreReadBackEqual) {
  EXPECT_EQ(descriptionFromXml(toXml(flat())), flat());
  EXPECT_EQ(descriptionFromXml(toXml(DescribedBuilding{})), DescribedBuilding{});
}

TEST(DescriptionXml, RandomDescriptionsAreReadBackEqual) {
  hyselam::testing::expectReadBack(
      500, [](unsigned seed) { return testing::RandomDescriptions(seed).description(); },
      [](const std::string& text) { return descriptionFromXml(text); });
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
// Whatever a file says: it is read or refused.
RC_GTEST_PROP(DescriptionXml, DamagedFilesNeverCrash, (unsigned seed)) {
  const std::string text =
      hyselam::testing::damaged(toXml(testing::RandomDescriptions(seed).description()), seed);
  try {
    checkDescription(descriptionFromXml(text), "damaged");
  } catch (const hyselam::InputError&) {
  }
}
#endif

TEST(DescriptionXml, FilesFollowTheSchema) {
  if (!hyselam::testing::haveXmllint()) GTEST_SKIP() << "no xmllint here";
  const auto valid = [](const std::string& text) {
    return hyselam::testing::follows("description.xsd", text);
  };
  const std::string text = toXml(flat());
  EXPECT_TRUE(valid(text)) << text;
  for (const auto& [from, to] :
       {std::make_pair("side=\"left\"", "side=\"up\""), std::make_pair("to=\"4\"", "to=\"5\""),
        std::make_pair("length=\"6\"", "length=\"-6\""),
        std::make_pair("name=\"house\"", "name=\"\"")}) {
    EXPECT_FALSE(valid(hyselam::testing::replaced(text, from, to))) << from << " as " << to;
  }
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::string random = toXml(testing::RandomDescriptions(seed).description());
    EXPECT_TRUE(valid(random)) << random;
  }
}

TEST(DescriptionXml, RefusesOtherFiles) {
  expectError(errorOf(""), {"h.xml", "no XML"});
  expectError(errorOf("on your left"), {"h.xml", "no XML"});
  expectError(errorOf("<a/><b/>"), {"one outermost element"});
  expectError(errorOf("<description/>"), {"<description>", "this is no description"});
  expectError(errorWith("urn:hyselam:description:1", "urn:hyselam:topological_map:1"),
              {"line 2", "this is no description"});
  expectError(errorWith("version=\"1\" robot", "version=\"3\" robot"),
              {"has version 3, this program reads 1 to 2; it was written by a newer HySeLAM"});
  expectError(errorOf("<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>"), {"not allowed"});
  expectError(errorOf(std::string("<a>\0</a>", 8)), {"not UTF-8"});
  expectError(errorOf("<a>\xff</a>"), {"not UTF-8"});
  hyselam::XmlLimits limits;
  limits.max_bytes = 100;
  expectError(errorOf(toXml(flat()), limits), {"bytes, more than 100"});
  limits = {};
  limits.max_elements = 3;
  expectError(errorOf(toXml(flat()), limits), {"more than 3 elements"});
  expectError(errorOf(hyselam::testing::nested(40)), {"nested too deeply"});
}

TEST(DescriptionXml, RefusesUnknownParts) {
  expectError(errorWith("side=\"left\"", "side=\"up\""), {"<connection>", "'side' must be"});
  expectError(errorWith("side=\"left\"", ""), {"<connection>", "'side' is missing"});
  expectError(errorWith("order=\"3\"", "order=\"-1\""), {"<connection>", "'order' is negative"});
  expectError(errorWith("order=\"3\"", "order=\"1000000\""), {"beyond the 1000000th"});
  expectError(errorWith("order=\"3\"", "order=\"0.5\""), {"<connection>", "no whole number"});
  expectError(errorWith("to=\"4\"", "to=\"5\""), {"place 5, which is missing"});
  expectError(errorWith("to=\"4\"", "to=\"2\""), {"connected twice"});
  expectError(errorWith("to=\"4\"", "to=\"1\""), {"with itself"});
  expectError(errorWith("robot_place=\"1\"", "robot_place=\"7\""), {"the robot's place", "7"});
  expectError(errorWith("id=\"2\"", "id=\"1\""), {"place 1 stands there twice"});
  expectError(errorWith("id=\"2\"", "id=\"0\""), {"<place>", "no id"});
  expectError(errorWith("kind=\"corridor\"", "kind=\"cave\""), {"<place>", "'kind' must be"});
  expectError(errorWith("length=\"6\"", "length=\"0\""), {"place 2", "not > 0"});
  expectError(errorWith("length=\"6\"", "length=\"nan\""), {"<place>", "no finite number"});
  expectError(errorWith("parts=\"6\"", "parts=\"0\""), {"place 4", "fewer than one part"});
  expectError(errorWith("place_count=\"3\"", "place_count=\"0\""), {"fewer than one place"});
  expectError(errorWith("name=\"house\"", "name=\"\""), {"place 4 has no name"});
  expectError(errorWith("name=\"house\"", "name=\"a&#7;b\""), {"place 4", "control character"});
  expectError(errorWith("<alias name=\"John", "<alias name=\"&#2;John"), {"an alias", "control"});
  expectError(errorWith("kind=\"between\"", "kind=\"over\""), {"<relation>", "'kind' must be"});
  expectError(errorWith(" c=\"4\"", ""), {"a relation names place 0"});
  expectError(errorWith("b=\"1\" c=\"4\"", "b=\"1\" c=\"2\""), {"names a place twice"});
  expectError(errorWith("name=\"house\"", "name=\"house\" colour=\"red\""), {"'colour'"});
  expectError(errorWith("<relation", "<story/><relation"), {"<story>", "not known here"});
}

TEST(DescriptionXml, FilesAreReplacedAtOnce) {
  const TemporaryDirectory dir;
  saveXml(dir / "h.xml", flat());
  EXPECT_EQ(loadDescription(dir / "h.xml"), flat());
  DescribedBuilding bad = flat();
  bad.places[1].area = std::numeric_limits<double>::quiet_NaN();
  const std::string before = hyselam::testing::fileBytes(dir / "h.xml");
  EXPECT_THROW(saveXml(dir / "h.xml", bad), hyselam::InputError);
  EXPECT_EQ(hyselam::testing::fileBytes(dir / "h.xml"), before);
  EXPECT_EQ(dir.fileCount(), 1u);
  EXPECT_THROW(loadDescription(dir / "none.xml"), hyselam::InputError);
}

}  // namespace
}  // namespace hyselam_topo

// "The third door on the left" stands for a place wherever a sentence takes one that has a name,
// and names nothing where a name is told.
#include <gtest/gtest.h>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/grammar/numbered_names.hpp"
#include "hyselam_language/testing/language_outlines.hpp"
#include "shipped_parser.hpp"

namespace hyselam_topo {
namespace {

std::string read(const std::string& text, const std::string& language) {
  ParseOptions options;
  options.language = language;
  std::string all;
  for (const Utterance& each : testing::shippedParser().parse(text, options).utterances) {
    all += (all.empty() ? "" : "; ") + testing::outline(each);
  }
  return all;
}

TEST(NumberedPlaces, StandWhereANameMayStand) {
  const std::vector<std::pair<const char*, const char*>> english{
      {"The pantry is opposite the third door on the left.", "opposite a=pantry b=<left 3>"},
      {"The pantry is beside the last room on your right.", "next_to a=pantry b=<right -1>"},
      {"Across from the second on the right is the pantry.", "opposite a=pantry b=<right 2>"},
      {"The pantry comes right after the fourth door on the left.",
       "located after=<left 4> places=pantry"},
      {"The pantry is between the first door on the right and the library.",
       "between a=pantry b=<right 1> c=library"},
      {"Go to the second door on the left.", "go_to places=<left 2>"},
      {"Go to the kitchen and then to the third right.", "go_to places=kitchen,<right 3>"},
      {"How do I get to the last door on the left?", "way_to place=<left -1>"},
      {"What is opposite the first room on the left?", "what_is_opposite place=<left 1>"},
      {"Who works in the second room on the right?", "owner_of place=<right 2>"}};
  for (const auto& [text, meaning] : english) EXPECT_EQ(read(text, "en"), meaning) << text;
  const std::vector<std::pair<const char*, const char*>> portuguese{
      {"A despensa fica em frente à terceira porta à esquerda.", "opposite a=despensa b=<left 3>"},
      {"A despensa fica ao lado da última do lado direito.", "next_to a=despensa b=<right -1>"},
      {"Vai para a segunda porta da esquerda.", "go_to places=<left 2>"},
      {"Quem trabalha na segunda sala à direita?", "owner_of place=<right 2>"}};
  for (const auto& [text, meaning] : portuguese) EXPECT_EQ(read(text, "pt"), meaning) << text;
}

TEST(NumberedPlaces, NameNothing) {
  for (const char* text :
       {"This is the third room on the left.", "You are in the last on the right.",
        "The kitchen is also known as the third door on the left.",
        "Rename the kitchen to the second on the left.",
        "Go to the kitchen, the second door on the left."}) {
    EXPECT_EQ(read(text, "en").find('<'), std::string::npos) << text << ": " << read(text, "en");
  }
  // One place, no list of two.
  EXPECT_EQ(read("Go to the second door on the left, the kitchen.", "en"),
            "go_to places=<left 2>; ? no_pattern");
  EXPECT_EQ(read("The third door on the left is the pantry.", "en"),
            "nth_neighbour nth=3 place=pantry side=left");
  EXPECT_EQ(read("A terceira porta à esquerda é a despensa.", "pt"),
            "nth_neighbour nth=3 place=despensa side=left");
}

/// Of another place than the robot's.
TEST(NumberedPlaces, OfSomethingElseAreNone) {
  for (const char* text : {"The pantry is next to the second door on the left of the lift.",
                           "Go to the first door on the left of the kitchen."}) {
    EXPECT_EQ(read(text, "en").find("<left"), std::string::npos) << text << read(text, "en");
  }
}

TEST(NumberedPlaces, AreFoundInAnyText) {
  const auto found = [](const std::string& text, const char* language) {
    std::string all;
    const auto& grammar = testing::shippedParser().grammar(language);
    for (const SaidName& name : numberedNamesIn(text, grammar)) {
      all += text.substr(name.range.begin, name.range.end - name.range.begin) + " = " + name.side +
             " " + std::to_string(name.number) + "; ";
    }
    return all;
  };
  EXPECT_EQ(found("My bike leans on the shelf in the third room on the right, mind you.", "en"),
            "third room on the right = right 3; ");
  EXPECT_EQ(found("Someone put glue in the last office on the left and tape in the 2nd door right.",
                  "en"),
            "last office on the left = left -1; 2nd door right = right 2; ");
  EXPECT_EQ(found("A bicicleta está na segunda sala da esquerda.", "pt"),
            "segunda sala da esquerda = left 2; ");
  // No places, or not within them.
  EXPECT_EQ(found("The glue is in the second drawer on the left.", "en"), "");
  EXPECT_EQ(found("The glue is beside the second door on the left.", "en"), "");
  EXPECT_EQ(found("The cups are in the first on the left.", "en"), "");
}

TEST(NumberedPlaces, AreWhatWasToldOfThatNumber) {
  const auto told = [](const std::string& text) {
    DescriptionBuilder builder(testing::shippedParser());
    const auto issues = builder.add(testing::shippedParser().parse(text));
    std::string all;
    for (const DescribedRelation& each : builder.building().relations) {
      all += builder.building().findPlace(each.a)->name + " " + toString(each.kind) + " " +
             builder.building().findPlace(each.b)->name;
    }
    return all + (issues.empty() ? "" : "? " + issues.front().reason);
  };
  EXPECT_EQ(told("You are in the corridor. The third door on the left is the bar. The pantry is "
                 "opposite the third door on the left."),
            "pantry opposite bar");
  EXPECT_EQ(told("You are in the corridor. The third door on the left is the bar. The pantry is "
                 "opposite the third door on the right."),
            "? what is 'third door on the right' called? Tell me that first");
}

/// "The fourth and the fifth on the right are offices."
TEST(NumberedPlaces, TwoNumbersAreTwoPlaces) {
  const auto rows = [](const std::string& text) {
    DescriptionBuilder builder(testing::shippedParser());
    const auto issues = builder.add(testing::shippedParser().parse(text));
    std::string all;
    for (const DescribedConnection& each : builder.building().connections) {
      all += builder.building().findPlace(each.to)->name + " " + toString(each.side) + " " +
             std::to_string(each.rank.value_or(0)) + "; ";
    }
    return all + (issues.empty() ? "" : "? " + issues.front().reason);
  };
  EXPECT_EQ(
      rows("You are in the corridor. The second and third door on the left are meeting rooms."),
      "meeting room left 2; meeting room left 3; ");
  EXPECT_EQ(rows("You are in the corridor. The last two on the right are changing rooms."),
            "changing room right -2; changing room right -1; ");
  EXPECT_EQ(rows("You are in the corridor. The first and the second on the left are the kitchen "
                 "and the library."),
            "kitchen left 1; library left 2; ");
  EXPECT_EQ(rows("Estás no corredor. As duas primeiras portas à esquerda são laboratórios."),
            "laboratório left 1; laboratório left 2; ");
  EXPECT_EQ(
      rows("You are in the corridor. The first two on the left are meeting rooms. The second is "
           "the bar."),
      "meeting room left 1; meeting room left 2; ? number 2 on the left is 'meeting room'");
  EXPECT_EQ(rows("You are in the corridor. The second and third door on the left are the library."),
            "? 2 were announced, 1 named");
}

}  // namespace
}  // namespace hyselam_topo

// The read-back: what is new, changed or gone between two descriptions.
#include <gtest/gtest.h>

#include "hyselam_language/building/describe_change.hpp"
#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {
namespace {

using Sentences = std::vector<std::string>;

DescribedBuilding rooms(const std::vector<std::string>& names) {
  DescribedBuilding building;
  for (const std::string& name : names) {
    DescribedPlace place;
    place.id = building.places.size() + 1;
    place.name = name;
    building.places.push_back(place);
  }
  return building;
}

DescribedConnection connection(Id from, Id to, Side side, std::size_t order = 0) {
  return {from, to, side, order};
}

DescribedRelation relation(RelationKind kind, Id a, Id b, Id c = 0) {
  return {kind, a, b, c};
}

const Grammar& english() {
  static const Grammar kGrammar = Grammar::shipped("en");
  return kGrammar;
}
const Grammar& portuguese() {
  static const Grammar kGrammar = Grammar::shipped("pt");
  return kGrammar;
}

TEST(DescribeChange, NothingNewIsNotTold) {
  const DescribedBuilding building = rooms({"kitchen", "corridor"});
  EXPECT_EQ(describeChange(building, building, english()), Sentences{});
  EXPECT_EQ(describeChange({}, {}, english()), Sentences{});
}

TEST(DescribeChange, NewPlacesAndWhereTheyLie) {
  const DescribedBuilding before = rooms({"corridor"});
  DescribedBuilding after = rooms({"corridor", "kitchen", "room B", "stairs"});
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"There is a place called kitchen.", "There is a place called room B.",
                       "There is a place called stairs."}));
  after.robot_place = 1;
  after.connections = {connection(1, 2, Side::kLeft), connection(1, 3, Side::kRight),
                       connection(1, 4, Side::kUnknown)};
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"This is the corridor.", "The kitchen is on the left of the corridor.",
                       "room B is on the right of the corridor.",
                       "There is a passage between the corridor and the stairs."}));
}

TEST(DescribeChange, RanksDistancesAndRows) {
  DescribedBuilding after = rooms({"corredor", "cozinha", "biblioteca", "escadas"});
  const DescribedBuilding before = after;
  after.connections = {connection(1, 2, Side::kLeft, 0), connection(1, 3, Side::kLeft, 1),
                       connection(1, 4, Side::kRight)};
  EXPECT_EQ(describeChange(before, after, portuguese()),
            (Sentences{"A cozinha e depois a biblioteca ficam à esquerda do corredor, por esta "
                       "ordem.",
                       "As escadas ficam à direita do corredor."}));
  after.connections[1].rank = 2;
  after.connections[2].distance = 10.0;
  EXPECT_EQ(describeChange(before, after, portuguese()),
            (Sentences{"A cozinha fica à esquerda do corredor.",
                       "O segundo lugar à esquerda do corredor é a biblioteca.",
                       "As escadas ficam à direita do corredor, a 10 metros."}));
  after.connections[1].rank = -1;
  after.connections[2].rank = 23;
  EXPECT_EQ(describeChange(before, after, portuguese()),
            (Sentences{"A cozinha fica à esquerda do corredor.",
                       "O último lugar à esquerda do corredor é a biblioteca.",
                       "O lugar número 23 à direita do corredor é as escadas, a 10 metros."}));
}

TEST(DescribeChange, WhatPlacesAreLike) {
  const DescribedBuilding before = rooms({"library", "stairs"});
  DescribedBuilding after = before;
  after.places[0].size_word = SizeWord::kLarge;
  after.places[0].doors = 2;
  after.places[0].floor = -2;
  after.places[0].aliases = {"Tom's office"};
  after.places[1].doors = 1;
  after.places[1].floor = 1;
  EXPECT_EQ(
      describeChange(before, after, english()),
      (Sentences{"The library is large.", "The library has 2 doors.",
                 "The library is 2 floors down.", "The library is also known as Tom's office.",
                 "The stairs have one door.", "The stairs are one floor up."}));
}

TEST(DescribeChange, RelationsAndDenials) {
  const DescribedBuilding before = rooms({"library", "stairs", "lab"});
  DescribedBuilding after = before;
  after.relations = {relation(RelationKind::kAfter, 1, 2),  relation(RelationKind::kAfter, 1, 2, 3),
                     relation(RelationKind::kBehind, 3, 2), relation(RelationKind::kLarger, 1, 3),
                     relation(RelationKind::kNextTo, 1, 3), relation(RelationKind::kAtSide, 1, 3)};
  after.relations[4].denied = after.relations[5].denied = true;
  after.relations[5].side = Side::kLeft;
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"The library comes right after the stairs.",
                       "The library comes right after the stairs on the way from the lab.",
                       "The lab is behind the stairs.", "The library is larger than the lab.",
                       "The library is not next to the lab.",
                       "The library is not on the left of the lab."}));
}

TEST(DescribeChange, WhatIsToldNoMore) {
  DescribedBuilding before = rooms({"corridor", "kitchen", "lab"});
  before.connections = {connection(1, 2, Side::kLeft), connection(1, 3, Side::kUnknown)};
  before.relations = {relation(RelationKind::kNextTo, 2, 3)};
  before.places[2].area = 20.0;
  DescribedBuilding after = before;
  after.connections = {connection(1, 2, Side::kRight), connection(1, 3, Side::kLeft)};
  after.relations.clear();
  after.places[2].area = 25.0;
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"The kitchen is on the right of the corridor.",
                       "The lab is on the left of the corridor.", "The lab has 25 square meters.",
                       "No longer: the kitchen is on the left of the corridor.",
                       "No longer: the kitchen is next to the lab.",
                       "No longer: the lab has 20 square meters."}));
  // A place that goes takes all with it.
  after.places.pop_back();
  after.connections.pop_back();
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"The kitchen is on the right of the corridor.", "The lab is gone.",
                       "No longer: the kitchen is on the left of the corridor."}));
  EXPECT_EQ(describeChange(before, {}, english()),
            (Sentences{"No place is left of the description."}));
}

TEST(DescribeChange, OtherNamesAndPlacesOfOneName) {
  DescribedBuilding before = rooms({"corridor", "kitchen"});
  DescribedBuilding after = before;
  after.places[1].name = "canteen";
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"The kitchen is now called canteen."}));
  before = rooms({"corridor"});
  after = rooms({"corridor", "toilet", "toilet"});
  after.connections = {connection(1, 2, Side::kLeft), connection(1, 3, Side::kRight)};
  EXPECT_EQ(describeChange(before, after, english()),
            (Sentences{"The toilet is on the left of the corridor.",
                       "Another toilet is on the right of the corridor."}));
}

}  // namespace
}  // namespace hyselam_topo

// Which patches belong together: odds, their model as a text, and clouds that need turning first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "segmentation/partition.hpp"
#include "segmentation/relation_model.hpp"

#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

namespace hyselam_objects {
namespace {

#ifdef HYSELAM_HAVE_RAPIDCHECK

/// The rule as it stands in the header, without a queue: after every step all sums are made anew.
std::vector<int> plainPartition(int members, const std::vector<PairOdds>& pairs) {
  std::vector<int> group(static_cast<std::size_t>(members));
  for (int i = 0; i < members; ++i) group[static_cast<std::size_t>(i)] = i;
  while (true) {
    std::map<std::pair<int, int>, double> sums;
    for (const PairOdds& pair : pairs) {
      const int a = group[static_cast<std::size_t>(pair.first)];
      const int b = group[static_cast<std::size_t>(pair.second)];
      if (a != b) sums[std::minmax(a, b)] += pair.odds;
    }
    const auto best = std::max_element(
        sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (best == sums.end() || best->second <= 0.0) return group;
    std::replace(group.begin(), group.end(), best->first.second, best->first.first);
  }
}

RC_GTEST_PROP(PartitionByOddsProperty, EqualsItsPlainTranscription, ()) {
  const int members = *rc::gen::inRange(2, 9);
  const auto pairs = *rc::gen::container<std::vector<PairOdds>>(
      rc::gen::map(rc::gen::tuple(rc::gen::inRange(0, members), rc::gen::inRange(0, members),
                                  rc::gen::inRange(-64, 65)),
                   [members](const std::tuple<int, int, int>& drawn) {  // sums of these are exact
                     const auto [a, b, odds] = drawn;
                     return PairOdds{a, a == b ? (b + 1) % members : b, 0.125 * odds};
                   }));
  const std::vector<int> found = partitionByOdds(members, pairs);
  const std::vector<int> plain = plainPartition(members, pairs);
  // Names of groups may differ in the transcription, their members may not.
  for (std::size_t i = 0; i < found.size(); ++i) {
    RC_ASSERT(found[i] <= static_cast<int>(i));
    for (std::size_t k = 0; k < i; ++k) {
      RC_ASSERT((found[i] == found[k]) == (plain[i] == plain[k]));
    }
  }
}

#endif

TEST(PartitionByOdds, EvidenceOfAllMembersCounts) {
  // 0 fits 1 and 1 fits 2, but 0 and 2 exclude each other: the better pair wins.
  EXPECT_EQ(partitionByOdds(3, {{0, 1, 2.0}, {1, 2, 1.0}, {0, 2, -4.0}}),
            (std::vector<int>{0, 0, 2}));
  // Two weak pieces of evidence outweigh one against.
  EXPECT_EQ(partitionByOdds(4, {{0, 1, 3.0}, {2, 3, 3.0}, {0, 2, 1.0}, {1, 3, 1.0}, {0, 3, -1.5}}),
            (std::vector<int>{0, 0, 0, 0}));
  EXPECT_EQ(partitionByOdds(2, {{1, 0, 0.0}}), (std::vector<int>{0, 1}));
  EXPECT_TRUE(partitionByOdds(0, {}).empty());
}

TEST(RelationModel, ShippedOneComesBackFromItsText) {
  const RelationModel& model = RelationModel::shipped();
  EXPECT_FALSE(model.origin.data.empty());
  EXPECT_EQ(RelationModel::fromText(model.toText(), "text").toText(), model.toText());
}

PatchRelation boxEdge() {
  PatchRelation edge;  // two faces of a box: a long edge, bent outwards by 90 degrees
  edge.second = 1;
  edge.smaller = 400;
  edge.border = edge.convex = 20;
  edge.turn = 1.5f;
  return edge;
}

TEST(RelationModel, JoinsAtConvexEdgesAndPartsAtConcaveOnes) {
  PatchRelation edge = boxEdge();
  for (const bool colors : {true, false}) {
    EXPECT_GT(RelationModel::shipped().oddsOfOneObject(edge, colors), 0.0);
  }
  std::swap(edge.convex, edge.concave);
  edge.turn = -1.5f;
  for (const bool colors : {true, false}) {
    EXPECT_LT(RelationModel::shipped().oddsOfOneObject(edge, colors), 0.0);
  }
}

TEST(RelationModel, BridgesWhatContinuesAndNothingSeenThrough) {
  PatchRelation bridge;
  bridge.second = 1;
  bridge.smaller = 200;
  bridge.hidden = bridge.continued = 15;
  bridge.angle = 0.05f;
  bridge.offset = 0.2f;
  bridge.gap = 0.05f;
  bridge.gap_ratio = 0.5f;
  bridge.outline = 0.95f;
  const RelationModel& model = RelationModel::shipped();
  const double joined = model.oddsOfOneObject(bridge, true);
  EXPECT_GT(joined, 0.0);
  PatchRelation other = bridge;
  other.chroma = 1.5f;  // of another color
  EXPECT_LT(model.oddsOfOneObject(other, true), joined);
  EXPECT_EQ(model.oddsOfOneObject(other, false), model.oddsOfOneObject(bridge, false));
  other = bridge;
  other.outline = 0.1f;
  EXPECT_LT(model.oddsOfOneObject(other, true), joined);
  other = bridge;
  other.gap = 0.25f;
  EXPECT_LT(model.oddsOfOneObject(other, true), joined);
  other = bridge;
  other.seen_through = 30;
  EXPECT_LT(model.oddsOfOneObject(other, true), joined);
  EXPECT_EQ(model.oddsOfOneObject({}, true), 0.0);
}

TEST(RelationModel, RefusesDamagedTexts) {
  const std::string text = RelationModel::shipped().toText();
  const std::string body = text.substr(0, text.rfind("checksum "));
  const auto refused = [](const std::string& changed, const std::string& place) {
    const std::string whole = changed + "checksum " + hyselam::crc32Text(changed) + "\n";
    try {
      RelationModel::fromText(whole, "changed");
      ADD_FAILURE() << "read: " << changed;
    } catch (const hyselam::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what();
    }
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string out = body;
    return out.replace(out.find(from), from.size(), to);
  };
  EXPECT_THROW(RelationModel::fromText("", "text"), hyselam::InputError);
  EXPECT_THROW(RelationModel::fromText(body, "text"), hyselam::InputError);
  EXPECT_THROW(RelationModel::fromText(replaced("turn ", "torn ") + text.substr(body.size()), "t"),
               hyselam::InputError);
  refused(replaced("relations 1", "relations 2"), "line 1");
  refused(replaced("contact 11", "contact 12"), "line 6");
  refused(replaced("turn ", "torn "), "line 9");
  refused(replaced("turn ", "turn x"), "line 9");
  refused(replaced("turn ", "turn nan "), "line 9");
  refused(body + "more\n", "more than the weights");
  refused(body.substr(0, body.rfind("concave_share")), "ends too early");
}

}  // namespace
}  // namespace hyselam_objects

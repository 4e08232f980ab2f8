#include <gtest/gtest.h>

#include "hyselam_topo/dialogue/change_history.hpp"

using hyselam_topo::ChangeHistory;
using hyselam_topo::Id;
using hyselam_topo::KnownBefore;
using Barrier = KnownBefore::Barrier;

namespace {

/// Before a change: place 1 and place 2 with these confirmed names ("" for none).
KnownBefore known(const std::string& one, const std::string& two, std::size_t statements = 0) {
  KnownBefore all;
  all.names.words[1];
  all.names.words[2];
  if (!one.empty()) all.names.words[1] = {{one, true}};
  if (!two.empty()) all.names.words[2] = {{two, true}};
  all.statements = all.after = statements;
  return all;
}

}  // namespace

TEST(ChangeHistory, SixteenChangesCanBeTakenBack) {
  ChangeHistory history;
  for (int i = 0; i < 20; ++i) history.add(known("name " + std::to_string(i), ""));
  for (int i = 19; i > 4; --i) {
    ASSERT_NE(nullptr, history.last());
    EXPECT_EQ(Barrier::kNone, history.barrier(0));
    EXPECT_EQ("name " + std::to_string(i), history.last()->names.words[1].front().text);
    history.dropLast();
  }
  EXPECT_EQ(Barrier::kTooLongAgo, history.barrier(0));
}

TEST(ChangeHistory, AStatementBehindTheLastChangeIsTakenBackFirst) {
  ChangeHistory history;
  EXPECT_TRUE(history.isStatementLast(0));
  history.add(known("", "", 2));
  EXPECT_FALSE(history.isStatementLast(2));
  EXPECT_TRUE(history.isStatementLast(3));
}

TEST(ChangeHistory, GuessesMakeNoDifference) {
  KnownBefore sure = known("kitchen", ""), unsure = sure;
  unsure.names.words[2] = {{"library", false}};
  EXPECT_TRUE(haveSameNames(sure.names, unsure.names));
  unsure.names.words[2].front().confirmed = true;
  EXPECT_FALSE(haveSameNames(sure.names, unsure.names));
}

TEST(ChangeHistory, ChangesOfLostPlacesAreBehindABarrier) {
  ChangeHistory history;
  history.add(known("", ""));                // place 1 becomes the kitchen,
  history.add(known("kitchen", ""));         // place 2 the library,
  history.add(known("kitchen", "library"));  // place 1 the canteen
  history.forgetPlaces({2}, known("canteen", "library"));
  ASSERT_NE(nullptr, history.last());
  EXPECT_EQ(Barrier::kNone, history.barrier(0));
  EXPECT_EQ(0u, history.last()->names.words.count(2));
  EXPECT_EQ(1u, history.last()->names.words.count(1));
  history.dropLast();
  EXPECT_EQ(Barrier::kPlaceGone, history.barrier(0));
  EXPECT_EQ(Barrier::kNone, history.barrier(1)) << "a statement since can be taken back";
  history.dropLast();
  EXPECT_EQ(nullptr, history.last());
}

TEST(ChangeHistory, NothingLostIsNoBarrier) {
  ChangeHistory history;
  history.add(known("", ""));
  history.forgetPlaces({}, known("kitchen", ""));
  EXPECT_EQ(Barrier::kNone, history.barrier(0));
}

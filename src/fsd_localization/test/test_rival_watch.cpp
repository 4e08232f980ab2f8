// What answers of the search say against a tracked pose: one alone is not believed, and the next
// must say it again of the same place, half a metre on.
#include <gtest/gtest.h>

#include "fsd_localization/search/rival_watch.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::Pose2;

TEST(RivalWatch, aPlaceMustBeBetterTwice) {
  RivalWatch watch;
  EXPECT_FALSE(watch.hasRival());
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.0));
  EXPECT_TRUE(watch.hasRival());
  // The robot has gone on by a metre, and so has its image at the other place.
  EXPECT_TRUE(watch.isBetterAgain(Pose2{30, 5, 1} * Pose2{1, 0, 0}, {3, 0, 0}, 11.0));
}

TEST(RivalWatch, whatIsToldAgainAtOnceSaysNothing) {
  RivalWatch watch;
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.0));
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.4));
  EXPECT_TRUE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.5)) << "the first one counts";
}

TEST(RivalWatch, anotherPlaceBeginsAnew) {
  RivalWatch watch;
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.0));
  EXPECT_FALSE(watch.isBetterAgain({50, 5, 1}, {3, 0, 0}, 11.0));
  EXPECT_FALSE(watch.isBetterAgain({31, 5, 1}, {3, 0, 0}, 11.6)) << "the one before the last";
  EXPECT_TRUE(watch.isBetterAgain({31, 5, 1}, {3, 0, 0}, 12.2));
}

TEST(RivalWatch, aPlaceThatDidNotMoveWithTheRobotIsAnother) {
  RivalWatch watch;
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 0}, {2, 0, 0}, 10.0));
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 0}, {5, 0, 0}, 13.0));
}

TEST(RivalWatch, nothingIsLeftAfterASearchThatFoundNothingBetter) {
  RivalWatch watch;
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.0));
  watch.reset();
  EXPECT_FALSE(watch.hasRival());
  EXPECT_FALSE(watch.isTooEarly(10.1));
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 11.0));
}

TEST(RivalWatch, theSecondAnswerRestsOnWhatWasSeenSinceTheFirst) {
  RivalWatch watch;
  EXPECT_FALSE(watch.isTooEarly(10.0)) << "there is no rival";
  EXPECT_DOUBLE_EQ(watch.ownScans(10.0, 5.0), 5.0);
  EXPECT_FALSE(watch.isBetterAgain({30, 5, 1}, {2, 0, 0}, 10.0));
  EXPECT_TRUE(watch.isTooEarly(11.4));
  EXPECT_FALSE(watch.isTooEarly(11.5));
  EXPECT_DOUBLE_EQ(watch.ownScans(11.5, 5.0), 1.5) << "none that the first answer had";
  EXPECT_DOUBLE_EQ(watch.ownScans(20.0, 5.0), 5.0);
}

// When a tracked pose explains the last metres worse than usual.
#include <gtest/gtest.h>

#include "fsd_localization/search/score_watch.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header

TEST(ScoreWatch, looksOnceInAMetre) {
  ScoreWatch watch;
  EXPECT_FALSE(watch.isDue(0.9));
  EXPECT_TRUE(watch.isDue(1.0));
  watch.look(1.0, 0.8);
  EXPECT_FALSE(watch.isDue(1.9));
  EXPECT_TRUE(watch.isDue(2.0));
  watch.reset();
  EXPECT_FALSE(watch.isDue(1.9)) << "another pose is no reason to look earlier";
}

TEST(ScoreWatch, theFirstLookTellsWhatIsUsual) {
  ScoreWatch watch;
  EXPECT_FALSE(watch.isWorse());
  watch.look(1.0, 0.3);
  EXPECT_FALSE(watch.isWorse()) << "a low score alone says nothing";
  watch.look(2.0, 0.3 - 0.9 * ScoreWatch::kWorse);
  EXPECT_FALSE(watch.isWorse());
  watch.look(3.0, 0.3 - 1.1 * ScoreWatch::kWorse);
  EXPECT_TRUE(watch.isWorse());
  watch.look(4.0, 0.3);
  EXPECT_FALSE(watch.isWorse());
}

TEST(ScoreWatch, whatStaysBecomesUsual) {
  ScoreWatch watch;
  watch.look(0.0, 0.8);
  int worse = 0;
  for (int m = 1; m <= 100; ++m) {
    watch.look(m, 0.6);
    worse += watch.isWorse();
  }
  // 0.2 below falls to 0.08 below: (29 / 30)^27 is 0.4.
  EXPECT_NEAR(worse, 28, 1);
  EXPECT_FALSE(watch.isWorse());
}

TEST(ScoreWatch, isResetWithAnotherPose) {
  ScoreWatch watch;
  watch.look(1.0, 0.8);
  watch.look(2.0, 0.5);
  EXPECT_TRUE(watch.isWorse());
  watch.reset();
  EXPECT_FALSE(watch.isWorse());
  watch.look(3.0, 0.5);
  EXPECT_FALSE(watch.isWorse());
}

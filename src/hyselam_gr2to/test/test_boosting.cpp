// The learner behind the border model: it finds what is in the samples, keeps to what may only
// rise, and gives the same trees again.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/rng.hpp"
#include "train/boosting.hpp"
#include "train/room_scores.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header

namespace {

/// One place where x0 + x1 > 1 but for a share of errors; x2 means nothing.
Samples made(int n, double errors, std::uint64_t seed) {
  hyselam::Rng rng(seed);
  Samples s;
  s.features = 3;
  for (int i = 0; i < n; ++i) {
    const double a = rng.uniform(0.0, 1.0), b = rng.uniform(0.0, 1.0), c = rng.uniform(0.0, 1.0);
    s.values.insert(s.values.end(), {a, b, c});
    s.one_place.push_back((a + b > 1.0) != (rng.uniform(0.0, 1.0) < errors));
    s.weights.push_back(1.0);
  }
  return s;
}

double wrong(const BoostedTrees& trees, const Samples& s) {
  int count = 0;
  for (std::size_t i = 0; i < s.size(); ++i)
    count += (trees(&s.values[3 * i]) > 0.0) != (s.one_place[i] != 0);
  return static_cast<double>(count) / static_cast<double>(s.size());
}

}  // namespace

TEST(Boosting, LearnsTheRuleDespiteErrors) {
  const BoostedTrees trees = boost(made(3000, 0.1, 1), {});
  EXPECT_LT(wrong(trees, made(2000, 0.0, 2)), 0.06);
}

TEST(Boosting, RespectsMonotoneFeatures) {
  BoostingParams params;
  params.monotone = {1, 1, 0};
  const BoostedTrees trees = boost(made(1000, 0.3, 3), params);
  hyselam::Rng rng(4);
  for (int i = 0; i < 500; ++i) {
    double x[3] = {rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0)};
    double last = -1e9;
    for (x[0] = 0.0; x[0] <= 1.0; x[0] += 0.01) {
      const double odds = trees(x);
      ASSERT_GE(odds, last - 1e-12);
      last = odds;
    }
  }
}

TEST(Boosting, SameSamplesSameTrees) {
  const BoostedTrees a = boost(made(500, 0.2, 5), {}), b = boost(made(500, 0.2, 5), {});
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  for (std::size_t i = 0; i < a.nodes().size(); ++i)
    EXPECT_EQ(a.nodes()[i].threshold, b.nodes()[i].threshold);
}

TEST(Boosting, HeavierSamplesWin) {
  // Twice the same place in the space of features, opposite answers: the heavier one wins.
  Samples s;
  s.features = 1;
  for (int i = 0; i < 200; ++i) {
    s.values.push_back(0.0);
    s.one_place.push_back(i % 2 == 0);
    s.weights.push_back(i % 2 == 0 ? 3.0 : 1.0);
  }
  const double x = 0.0;
  EXPECT_NEAR(std::log(3.0), boost(s, {})(&x), 0.15);
}

// The cases of score_segmentation.py --self-test.
TEST(RoomScores, EqualTheReferenceScript) {
  const RoomScores same = scoreRooms({{0, 400, 0}, {0, 0, 400}}, 2);
  EXPECT_DOUBLE_EQ(1.0, same.precision);
  EXPECT_DOUBLE_EQ(1.0, same.recall);
  EXPECT_DOUBLE_EQ(1.0, same.mcc);
  EXPECT_DOUBLE_EQ(1.0, same.f1);

  const RoomScores one = scoreRooms({{20, 400, 400}}, 2);
  EXPECT_DOUBLE_EQ(0.5, one.precision);
  EXPECT_DOUBLE_EQ(1.0, one.recall);
  EXPECT_DOUBLE_EQ(0.0, one.mcc);

  const RoomScores split = scoreRooms({{0, 300, 0}, {0, 0, 400}, {0, 101, 0}}, 2);
  EXPECT_DOUBLE_EQ(1.0, split.precision);
  EXPECT_DOUBLE_EQ((300.0 / 401.0 + 1.0) / 2.0, split.recall);
  EXPECT_DOUBLE_EQ(0.8, split.f1);
  const double pair = 300.0 * 400.0 / std::sqrt(300.0 * 401.0 * 501.0 * 400.0);
  EXPECT_NEAR((1.0 + pair) / 3.0, split.mcc, 1e-12);

  // 100 cells are too few for a place.
  EXPECT_EQ(1.0, scoreRooms({{500, 100, 0}, {0, 0, 100}}, 2).places);
}

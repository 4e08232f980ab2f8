// What becomes of far loops: turns to search at, company, belief and probability.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"
#include "ngram_slam/slam/path_segment.hpp"
#include "ngram_slam/slam/segment_context.hpp"
#include "signature_loop.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::Rng;

TEST(SegmentContext, tellsByHowMuchWhatIsSeenIsTurned) {
  Rng rng(29);
  for (int i = 0; i < 50; ++i) {
    hyselam_scan_matching::SurfacePoints points;
    for (int wall = 0; wall < 6; ++wall) {
      const double x = rng.uniform(-15.0, 15.0), y = rng.uniform(-15.0, 15.0),
                   bearing = rng.uniform(-3.0, 3.0);
      for (int k = 0; k < 60; ++k) {
        points.push_back({x + 0.1 * k * std::cos(bearing), y + 0.1 * k * std::sin(bearing)});
      }
    }
    const double turn = rng.uniform(-3.1, 3.1);
    // What was seen at heading 0 is seen at heading `turn`.
    const auto turned = hyselam_scan_matching::transformed({0.0, 0.0, -turn}, points);
    const auto turns = likelyTurns(points, turned, 2);
    ASSERT_EQ(turns.size(), 2U);
    EXPECT_LT(std::abs(hyselam::normalizeAngle(turns[0] - turn)), hyselam::radians(6.5)) << i;
  }
  EXPECT_EQ(likelyTurns({}, {}, 3).size(), 3U);
}

TEST(LoopCompany, outweighsALoopThatContradictsIt) {
  std::vector<SlamKeyframe> keyframes;
  for (int i = 0; i < 200; ++i) {
    SlamKeyframe k;
    k.pose = {static_cast<double>(i), 0.0, 0.0};
    k.path_length = i;
    keyframes.push_back(k);
  }
  const auto loop = [](int older, int newer) {
    SlamLoop l;
    l.older = older;
    l.newer = newer;
    l.inlier_ratio = 0.8;
    return l;
  };
  const std::vector<SlamLoop> others{loop(10, 150), loop(12, 152), loop(14, 154)};
  const LoopParams params;
  EXPECT_TRUE(companyOf(loop(16, 156), others, keyframes, {}, params).isTrusted(params));
  const LoopCompany alias = companyOf(loop(46, 156), others, keyframes, {}, params);
  EXPECT_FALSE(alias.isTrusted(params));
  EXPECT_NEAR(alias.contradiction, 3 * 0.8, 1e-9);
  EXPECT_NEAR(alias.support, 0.8, 1e-9);
  // Far along the way nobody is asked.
  EXPECT_TRUE(companyOf(loop(46, 190), others, keyframes, {}, params).isTrusted(params));
}

namespace {

/// A straight way of keyframes a metre apart.
std::vector<SlamKeyframe> straightWay(int n) {
  std::vector<SlamKeyframe> keyframes;
  for (int i = 0; i < n; ++i) {
    SlamKeyframe k;
    k.pose = {static_cast<double>(i), 0.0, 0.0};
    k.path_length = i;
    k.scan = std::make_shared<const hyselam::LaserScan>();
    k.points = std::make_shared<const hyselam_scan_matching::SurfacePoints>();
    keyframes.push_back(k);
  }
  return keyframes;
}

}  // namespace

TEST(FarLoops, waitForTwoOthersThatAgree) {
  const auto keyframes = straightWay(200);
  const LoopParams params;
  std::vector<SlamLoop> waiting;
  EXPECT_TRUE(believeFarLoops(signatureLoop(10, 150), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(signatureLoop(12, 152), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_EQ(waiting.size(), 2U);
  const auto believed =
      believeFarLoops(signatureLoop(14, 154), {}, keyframes, {}, params, &waiting);
  ASSERT_EQ(believed.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(believed[i].newer, 154 - 2 * static_cast<int>(i));
  EXPECT_TRUE(waiting.empty());
  // From one spot they are one opinion, and the same loop twice is one.
  for (const int newer : {150, 151, 151}) {
    EXPECT_TRUE(
        believeFarLoops(signatureLoop(newer - 140, newer), {}, keyframes, {}, params, &waiting)
            .empty());
  }
  // With an accepted one no other is needed.
  waiting.clear();
  EXPECT_EQ(believeFarLoops(signatureLoop(20, 160), {signatureLoop(14, 154)}, keyframes, {}, params,
                            &waiting)
                .size(),
            1U);
}

TEST(FarLoops, needFewerWhereWordsProposedOne) {
  const auto keyframes = straightWay(200);
  const LoopParams params;
  for (const LoopSource source : {LoopSource::kProximity, LoopSource::kNgram}) {
    std::vector<SlamLoop> waiting;
    SlamLoop first = signatureLoop(10, 150), second = signatureLoop(13, 153);
    first.source = LoopSource::kProximity;
    second.source = source;
    EXPECT_TRUE(believeFarLoops(first, {}, keyframes, {}, params, &waiting).empty());
    EXPECT_EQ(believeFarLoops(second, {}, keyframes, {}, params, &waiting).size(),
              source == LoopSource::kNgram ? 2U : 0U);
  }
}

TEST(FarLoops, countOnceWhatIsSaidTwice) {
  const auto keyframes = straightWay(200);
  const LoopParams params;
  std::vector<SlamLoop> waiting;
  for (const int newer : {150, 152, 152, 150, 152}) {
    EXPECT_TRUE(
        believeFarLoops(signatureLoop(newer - 140, newer), {}, keyframes, {}, params, &waiting)
            .empty());
  }
  EXPECT_EQ(waiting.size(), 2U);
  // Nor is an accepted one believed again; one that contradicts it is heard.
  const std::vector<SlamLoop> accepted{signatureLoop(10, 150)};
  waiting.clear();
  EXPECT_TRUE(
      believeFarLoops(signatureLoop(10, 150), accepted, keyframes, {}, params, &waiting).empty());
  EXPECT_TRUE(waiting.empty());
  SlamLoop other = signatureLoop(10, 150);
  other.measured = {30.0, 0.0, 0.0};
  EXPECT_TRUE(believeFarLoops(other, accepted, keyframes, {}, params, &waiting).empty());
  EXPECT_EQ(waiting.size(), 1U);
  EXPECT_GT(companyOf(signatureLoop(10, 150), waiting, keyframes, {}, params).contradiction, 0.0);
}

TEST(FarLoops, agreeInPairs) {
  const auto keyframes = straightWay(200);
  LoopParams params;
  params.consistency_distance_per_meter = 0.0;
  std::vector<SlamLoop> waiting;
  const auto shifted = [](int newer, double y) {
    SlamLoop l = signatureLoop(newer - 140, newer);
    l.measured.y = y;
    return l;
  };
  // The second agrees with both, but these do not agree with each other.
  EXPECT_TRUE(believeFarLoops(shifted(150, 0.0), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(shifted(152, 0.2), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(shifted(154, 0.4), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_GE(believeFarLoops(shifted(156, 0.3), {}, keyframes, {}, params, &waiting).size(), 3U);
}

TEST(FarLoops, giveUpTheOldestThatWait) {
  const auto keyframes = straightWay(2000);
  const LoopParams params;
  std::vector<SlamLoop> waiting;
  for (int i = 0; i < 450; ++i) {
    believeFarLoops(signatureLoop((i * 7) % 900, 1000 + i), {}, keyframes, {}, params, &waiting);
  }
  EXPECT_LE(waiting.size(), 400U);
}

TEST(FarLoops, areEachAskedForTheirCompany) {
  const auto keyframes = straightWay(200);
  LoopParams params;
  params.company_half_length = 3.0;
  // Three that agree, the first of which two others contradict: it neither counts nor is believed.
  std::vector<SlamLoop> waiting{signatureLoop(60, 148), signatureLoop(61, 149)};
  EXPECT_TRUE(believeFarLoops(signatureLoop(10, 150), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(signatureLoop(14, 154), {}, keyframes, {}, params, &waiting).empty());
  EXPECT_TRUE(believeFarLoops(signatureLoop(17, 157), {}, keyframes, {}, params, &waiting).empty());
  const auto believed =
      believeFarLoops(signatureLoop(20, 160), {}, keyframes, {}, params, &waiting);
  ASSERT_EQ(believed.size(), 3U);
  for (const SlamLoop& l : believed) EXPECT_GE(l.newer, 154);
  EXPECT_EQ(waiting.size(), 3U);
}

TEST(FarLoops, waitWhileTheyAreImprobable) {
  const auto keyframes = straightWay(200);
  LoopParams params;
  std::vector<SlamLoop> waiting;
  params.min_signature_probability = 1.0;
  for (const int newer : {150, 152, 154, 156}) {
    EXPECT_TRUE(
        believeFarLoops(signatureLoop(newer - 140, newer), {}, keyframes, {}, params, &waiting)
            .empty());
  }
  params.min_signature_probability = 0.5;
  EXPECT_EQ(believeFarLoops(signatureLoop(18, 158), {}, keyframes, {}, params, &waiting).size(),
            5U);
}

TEST(LoopProbability, risesWithFitAndCompanyAndFallsWithContradiction) {
  SlamLoop loop = signatureLoop(1, 2);
  const auto probability = [&](double fit, double others, double contradiction) {
    loop.fit = fit;
    return loopProbability(loop, {loop.inlier_ratio + others, contradiction});
  };
  for (const double fit : {0.85, 0.9, 0.99, 1.0}) {
    for (const double others : {0.0, 1.0, 5.0}) {
      const double p = probability(fit, others, 0.5);
      EXPECT_GT(p, 0.0);
      EXPECT_LT(p, 1.0);
      EXPECT_GT(probability(fit, others + 1.0, 0.5), p);
      EXPECT_LT(probability(fit, others, 2.0), p);
      if (fit < 0.99) {
        EXPECT_GT(probability(fit + 0.01, others, 0.5), p);
      }
    }
  }
  // One alone that barely fits is likelier wrong than right; one of six that fit well is right.
  EXPECT_LT(probability(0.86, 0.0, 0.0), 0.6);
  EXPECT_GT(probability(0.97, 4.0, 0.0), 0.98);
}

TEST(SegmentAround, keepsToItsRunAndToThePath) {
  auto keyframes = straightWay(60);
  for (std::size_t i = 40; i < 60; ++i) keyframes[i].run = 1;
  const double all = std::numeric_limits<double>::infinity();
  const auto middle = segmentAround(keyframes, 20, 5.0, all);
  ASSERT_EQ(middle.size(), 11U);
  EXPECT_NEAR(middle.front().pose.x, -5.0, 1e-9);
  EXPECT_NEAR(middle.back().pose.x, 5.0, 1e-9);
  EXPECT_EQ(segmentAround(keyframes, 38, 5.0, all).size(), 7U);
  EXPECT_EQ(segmentAround(keyframes, 41, 5.0, all).size(), 7U);
  EXPECT_EQ(segmentAround(keyframes, 20, 5.0, 22.0).size(), 8U);
  EXPECT_TRUE(segmentAround(keyframes, 20, 5.0, 10.0).empty());
}

// Observations, regions, words and levels against the thesis' algorithms written down plainly.
#include <gtest/gtest.h>

#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/words/density_regions.hpp"
#include "ngram_slam/words/word_lattice.hpp"
#include "transcription/words.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::InputError;
using hyselam::ParameterError;
using hyselam::Pose2;
using hyselam::testing::messageOf;

namespace {

std::vector<DensityRegion> regionsOf(const std::string& classes, int t_o) {
  DensityRegionBuilder builder(t_o);
  std::vector<DensityRegion> out;
  for (char c : classes) {
    if (const auto r = builder.add(c)) out.push_back(*r);
  }
  if (const auto r = builder.finish()) out.push_back(*r);
  return out;
}

/// "A5 B7": class and size of each region.
std::string told(const std::vector<DensityRegion>& regions) {
  std::string text;
  for (const DensityRegion& r : regions) {
    text += (text.empty() ? "" : " ") + std::string(1, static_cast<char>(r.density_class)) +
            std::to_string(r.size());
  }
  return text;
}

std::vector<int> randomClasses(hyselam::Rng& rng, std::size_t n, std::uint32_t shortest) {
  std::vector<int> classes;
  while (classes.size() < n) {
    const int c = static_cast<int>(rng.below(3));
    const std::uint32_t length = shortest + rng.below(12);
    if (!classes.empty() && classes.back() == c) continue;
    classes.insert(classes.end(), length, c);
  }
  return classes;
}

}  // namespace

TEST(ObservationStore, returnsObservationsUpToRounding) {
  ObservationStore store;
  hyselam::Rng rng(3);
  std::vector<DensityObservation> all;
  for (int i = 0; i < 500; ++i) {
    if (i % 200 == 0) store.startRun();
    DensityObservation o;
    o.stamp = 1e9 + 0.1 * i;
    o.base_in_odom = {5e6 + rng.uniform(-1000, 1000), rng.uniform(-1000, 1000), rng.uniform(-4, 4)};
    o.soft = rng.uniform();
    if (i % 3 != 0) o.hard = rng.uniform();
    o.frontiers = i % 5;
    all.push_back(o);
    ASSERT_EQ(store.append(o), static_cast<std::uint32_t>(i));
  }
  ASSERT_EQ(store.runs(), 3u);
  EXPECT_EQ(store.runBegin(1), 200u);
  EXPECT_EQ(store.runEnd(2), 500u);
  EXPECT_EQ(store.runOf(199), 0u);
  EXPECT_EQ(store.runOf(200), 1u);
  for (std::uint32_t i = 0; i < 500; ++i) {
    const DensityObservation o = store[i];
    EXPECT_EQ(o.stamp, all[i].stamp);
    EXPECT_NEAR(o.base_in_odom.x, all[i].base_in_odom.x, 0.6e-4);
    EXPECT_NEAR(o.base_in_odom.y, all[i].base_in_odom.y, 0.6e-4);
    EXPECT_NEAR(hyselam::normalizeAngle(o.base_in_odom.theta - all[i].base_in_odom.theta), 0, 1e-8);
    EXPECT_NEAR(o.soft, all[i].soft, 1e-5);
    ASSERT_EQ(o.hard.has_value(), all[i].hard.has_value());
    if (o.hard) {
      EXPECT_NEAR(*o.hard, *all[i].hard, 1e-5);
    }
    EXPECT_EQ(o.frontiers, all[i].frontiers);
  }
}

TEST(ObservationStore, refusesInvalidObservationsByName) {
  ObservationStore store;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refusal = [&](const std::function<void(DensityObservation&)>& change) {
    DensityObservation o;
    change(o);
    return messageOf<InputError>([&] { store.append(o); });
  };
  EXPECT_NE(refusal([&](DensityObservation& o) { o.soft = nan; }).find("soft density"),
            std::string::npos);
  EXPECT_NE(refusal([&](DensityObservation& o) { o.hard = 1.5; }).find("hard density"),
            std::string::npos);
  EXPECT_NE(refusal([&](DensityObservation& o) { o.stamp = nan; }).find("stamp"),
            std::string::npos);
  EXPECT_NE(refusal([&](DensityObservation& o) { o.base_in_odom.y = nan; }).find("pose"),
            std::string::npos);
  EXPECT_NE(refusal([&](DensityObservation& o) { o.frontiers = -1; }).find("frontiers"),
            std::string::npos);
  EXPECT_EQ(store.size(), 0u);
  EXPECT_EQ(refusal([](DensityObservation&) {}), "");
  EXPECT_NE(refusal([](DensityObservation& o) { o.base_in_odom.x = 3e5; }).find("200 km"),
            std::string::npos);
  EXPECT_EQ(store.size(), 1u);
}

TEST(DistanceSampler, measuresLengthAtAnyScanRate) {
  for (double scan_step : {0.01, 0.07, 0.1, 0.25, 1.3}) {
    DistanceSampler sampler(0.1);
    std::size_t count = 0;
    Pose2 last;
    for (int i = 0; i * scan_step <= 26.0 + 1e-9; ++i) {
      for (const Pose2& p : sampler.due({i * scan_step, 2.0, 0.5})) {
        if (count > 0) {
          EXPECT_GE(hyselam::distance(last, p), 0.1 - 1e-6);
        }
        last = p;
        ++count;
      }
    }
    // One for the start; scans that do not fall on steps lose a fraction of one each.
    EXPECT_NEAR(static_cast<double>(count), 1 + 26.0 / 0.1, scan_step == 0.07 ? 80 : 2)
        << scan_step;
  }
}

TEST(DistanceSampler, standingStillOrJumpingIsNoPath) {
  DistanceSampler sampler(0.1);
  EXPECT_EQ(sampler.due({0, 0, 0}).size(), 1u);
  EXPECT_EQ(sampler.due({0.03, 0, 1}).size(), 0u);
  EXPECT_EQ(sampler.due({100, 0, 1}).size(), 1u);
  EXPECT_EQ(sampler.due({100.2, 0, 1}).size(), 2u);
  EXPECT_NE(messageOf<ParameterError>([] { DistanceSampler s(0.0); }), "");
}

TEST(DensityRegions, anInterruptionNeitherMakesARegionNorSplitsOne) {
  EXPECT_EQ(told(regionsOf("AAAAAAAABBBBBBAAAAAAA", 4)), "A8 B6 A7");
  EXPECT_EQ(told(regionsOf("AAAAAAAABBBAAAAAAA", 4)), "A18");        // shorter than t_o
  EXPECT_EQ(told(regionsOf("AAAAAAAABBBBAAAAAAA", 4)), "A8 B4 A7");  // just long enough
  EXPECT_EQ(told(regionsOf("AAAAAAAABCBAAAAABBBB", 4)), "A16 B4");   // mixed noise
  EXPECT_EQ(told(regionsOf("AAAAAAAAAAAABBBCCCC", 4)), "A15 C4");    // between two regions
  EXPECT_EQ(told(regionsOf("BBAAAAAAABBBBBBB", 4)), "A9 B7");        // at the start of a run
  EXPECT_EQ(told(regionsOf("AAAAAAAABB", 4)), "A10");                // at the end
  EXPECT_EQ(told(regionsOf("ABABAB", 2)), "");
  EXPECT_EQ(told(regionsOf("ABC", 1)), "A1 B1 C1");
  // Alg. 4.2 as printed splits the second example's region where it is older than t_o.
  std::deque<transcription::Observed> pending;
  for (char c : std::string("AAAAAAAABBBAAAAAAA")) pending.push_back({c, {}});
  EXPECT_EQ(transcription::buildRegion(pending, 4).size(), 8u);
}

TEST(DensityRegions, equalAlgorithm42WhereNothingIsShort) {
  for (int round = 0; round < 10000; ++round) {
    hyselam::Rng rng(42, static_cast<std::uint64_t>(round));
    const std::uint32_t t_o = 1 + rng.below(6);
    const auto classes = randomClasses(rng, 60, t_o + 1);
    std::deque<transcription::Observed> pending;
    for (int c : classes) pending.push_back({c, {}});
    std::vector<DensityRegion> expected;
    std::uint32_t begin = 0;
    for (;;) {
      const auto r = transcription::buildRegion(pending, t_o);
      if (r.empty()) break;
      expected.push_back({r.front().d, begin, begin + static_cast<std::uint32_t>(r.size())});
      begin = expected.back().end;
    }
    DensityRegionBuilder builder(static_cast<int>(t_o));
    std::vector<DensityRegion> found;
    for (int c : classes) {
      if (const auto r = builder.add(c)) found.push_back(*r);
    }
    if (const auto r = builder.finish()) found.push_back(*r);
    ASSERT_TRUE(found == expected) << "round " << round;
  }
}

TEST(DensityRegions, equalTheCorrectedRuleOnRandomClasses) {
  std::size_t absorbed = 0;
  for (int round = 0; round < 10000; ++round) {
    hyselam::Rng rng(43, static_cast<std::uint64_t>(round));
    const std::uint32_t t_o = 1 + rng.below(6);
    const auto classes = randomClasses(rng, 80, 1);
    const auto expected = transcription::regionsOfRun(classes, t_o);
    DensityRegionBuilder builder(static_cast<int>(t_o), 1000);
    std::vector<DensityRegion> found;
    for (int c : classes) {
      if (const auto r = builder.add(c)) found.push_back(*r);
    }
    if (const auto r = builder.finish()) found.push_back(*r);
    ASSERT_EQ(found.size(), expected.size()) << "round " << round;
    std::uint32_t begin = 1000;
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].density_class, expected[i].first);
      ASSERT_EQ(found[i].begin, begin);
      ASSERT_EQ(found[i].size(), expected[i].second);
      begin = found[i].end;
      absorbed += found[i].size() > 12;
    }
    if (!found.empty()) {
      ASSERT_EQ(begin, 1000 + classes.size());
    }
  }
  EXPECT_GT(absorbed, 1000u);
}

TEST(AngleVariation, isTheTurnInTheRegion) {
  // Fig. 4.7: along x, then along y.
  EXPECT_NEAR(angleVariation({0, 0, 0}, {3, 0.26, 0}, {3.05, 3, 1.5}), hyselam::radians(84), 0.02);
  EXPECT_NEAR(angleVariation({0, 0, 0}, {-3, 0, 0}, {-3, -3, 0}), hyselam::radians(90), 1e-9);
  // Across +-180 degrees, where a difference of arctangents would be off by a turn.
  EXPECT_NEAR(angleVariation({0, 0, 0}, {-3, 0.1, 0}, {-6, -0.1, 0}), 0.0, 0.11);
  // Straight to the left: dx = 0.
  EXPECT_NEAR(angleVariation({0, 0, 0}, {0, 3, 0}, {0, 6, 0}), 0.0, 1e-9);
  // Turning on the spot: headings instead of directions.
  EXPECT_NEAR(angleVariation({1, 1, 0.2}, {1.01, 1, 0.7}, {1.01, 1.01, 1.4}), 1.2, 1e-9);
}

TEST(WordLattice, levelsEqualAlgorithm52) {
  std::size_t alternatives = 0;
  for (int round = 0; round < 2000; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    hyselam::Rng rng(52, static_cast<std::uint64_t>(round));
    const int levels = 1 + static_cast<int>(rng.below(6));
    ObservationStore store;
    WordLattice text(levels,
                     [&](std::uint32_t b, std::uint32_t e) { return angleVariation(store, b, e); });
    const std::uint32_t runs = 1 + rng.below(3);
    std::vector<transcription::MultiLevelWords> expected;
    std::vector<std::size_t> offset;
    for (std::uint32_t run = 0; run < runs; ++run) {
      expected.emplace_back(levels - 1);
      offset.push_back(text.positions());
      store.startRun();
      text.startRun(store.size());
      Pose2 pose;
      int last_class = -1;
      const std::uint32_t regions = 1 + rng.below(25);
      for (std::uint32_t i = 0; i < regions; ++i) {
        int c = static_cast<int>(rng.below(3));
        if (c == last_class) c = (c + 1) % 3;
        last_class = c;
        transcription::Region region;
        const std::uint32_t size = 1 + rng.below(9), begin = store.size();
        for (std::uint32_t k = 0; k < size; ++k) {
          pose = pose * Pose2{0.1, 0.0, rng.uniform(-0.5, 0.5)};
          DensityObservation o;
          o.base_in_odom = pose;
          const auto at = store.append(o);
          region.push_back({c, store.pose(at)});
        }
        expected.back().add(region);
        text.push({c, size, static_cast<float>(angleVariation(store, begin, store.size()))});
      }
    }
    std::size_t count = 0;
    for (std::uint32_t run = 0; run < runs; ++run) {
      for (std::size_t level = 0; level < expected[run].W.size(); ++level) {
        for (const auto& w : expected[run].W[level]) {
          ++count;
          WordIndex i = 0;
          ASSERT_TRUE(text.findEndingAt(static_cast<Position>(offset[run] + w->last),
                                        static_cast<int>(level), &i));
          const DensityWord found = text.word(i);
          ASSERT_EQ(found.first, offset[run] + w->first);
          ASSERT_EQ(found.syllables.density_class, w->d);
          ASSERT_EQ(found.syllables.size, w->s);
          ASSERT_NEAR(hyselam::normalizeAngle(found.syllables.angle - w->a), 0.0, 1e-5);
          ASSERT_EQ(text.observationEnd(i) - text.observationBegin(i), w->O.size());
          const Pose2 start = store.pose(text.observationBegin(i));
          ASSERT_EQ(start.x, w->O.front().x.x);
          // The predecessor lists: the same words in the same order.
          const WordRange before = text.predecessors(i);
          ASSERT_EQ(before.size(), w->P.size());
          WordIndex k = before.begin;
          for (const auto* p : w->P) {
            ASSERT_EQ(text.level(k), p->level);
            ASSERT_EQ(text.first(k), offset[run] + p->first);
            ++k;
          }
          alternatives += level > 0;
        }
      }
    }
    ASSERT_EQ(text.words(), count);
  }
  EXPECT_GT(alternatives, 10000u);
}

TEST(WordLattice, refusesWordsOutOfRange) {
  EXPECT_NE(messageOf<ParameterError>([] { WordLattice t(0); }).find("levels"), std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([] { WordLattice t(17); }).find("levels"), std::string::npos);
  WordLattice text;
  EXPECT_NE(messageOf<ParameterError>([&] {
              text.push({256, 1, 0});
            }).find("class"),
            std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([&] {
              text.push({-1, 1, 0});
            }).find("class"),
            std::string::npos);
  EXPECT_NE(messageOf<ParameterError>([&] {
              text.push({1, 0, 0});
            }).find("size"),
            std::string::npos);
  EXPECT_EQ(text.words(), 0u);
  text.push({255, 1u << 30, 0});
  EXPECT_EQ(text.syllables(0).size, WordLattice::kMaxSize);
  EXPECT_EQ(text.syllables(0).density_class, 255);
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"

namespace {
rc::Gen<Syllables> anyWord() {
  return rc::gen::map(rc::gen::tuple(rc::gen::inRange(0, 3), rc::gen::inRange(1, 60),
                                     hyselam::testing::between(-hyselam::kPi, hyselam::kPi)),
                      [](const std::tuple<int, int, double>& t) {
                        return Syllables{
                            std::get<0>(t), static_cast<std::uint32_t>(std::get<1>(t)),
                            static_cast<float>(hyselam::normalizeAngle(std::get<2>(t)))};
                      });
}
}  // namespace

RC_GTEST_PROP(WordProperties, matchingIsReflexiveAndSymmetricAndWidensWithTheTolerance, ()) {
  const Syllables a = *anyWord(), b = *anyWord();
  WordTolerance t;
  t.size = *hyselam::testing::between(0.01, 0.9);
  t.angle = *hyselam::testing::between(0.01, 3.0);
  RC_ASSERT(wordsMatch(a, a, t));
  RC_ASSERT(wordsMatch(a, b, t) == wordsMatch(b, a, t));
  WordTolerance wider = t;
  wider.size += 0.05;
  wider.angle += 0.1;
  RC_ASSERT(!wordsMatch(a, b, t) || wordsMatch(a, b, wider));
}

RC_GTEST_PROP(WordProperties, angleVariationDoesNotDependOnTheFrame, ()) {
  const Pose2 frame = *hyselam::testing::anyPose();
  const Pose2 a = *hyselam::testing::anyPose(5.0), b = *hyselam::testing::anyPose(5.0),
              c = *hyselam::testing::anyPose(5.0);
  const double here = angleVariation(a, b, c);
  const double there = angleVariation(frame * a, frame * b, frame * c);
  RC_ASSERT(here > -hyselam::kPi - 1e-9 && here <= hyselam::kPi);
  RC_ASSERT(std::abs(hyselam::normalizeAngle(here - there)) < 1e-6);
}
#endif

// What goes beyond the thesis: densities that are the same both ways, classes with hysteresis,
// chance and probability of matches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/matching/match_confidence.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/words/language_model.hpp"
#include "ngram_slam/words/observation_sensor.hpp"
#include "random_texts.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::kPi;
using hyselam::Pose2;
using hyselam::radians;

namespace {

struct Wall {
  double x0, y0, x1, y1;
};

/// A corridor 2 m wide that runs 20 m east and then 20 m north, with a branch to the south at 10 m.
const std::vector<Wall>& cornerWithBranch() {
  static const std::vector<Wall> walls = {
      {-4, 1, 19, 1},   {19, 1, 19, 24},  {-4, -1, 9, -1},  {9, -1, 9, -8},   {9, -8, 11, -8},
      {11, -8, 11, -1}, {11, -1, 21, -1}, {21, -1, 21, 24}, {19, 24, 21, 24}, {-4, -1, -4, 1}};
  return walls;
}

/// 181 beams over the half plane before the robot.
hyselam::LaserScan scanFrom(const Pose2& pose, double stamp) {
  hyselam::LaserScan scan;
  scan.stamp = stamp;
  scan.angle_min = -kPi / 2;
  scan.angle_increment = kPi / 180;
  scan.range_min = 0.0;
  scan.range_max = 30.0;
  for (int i = 0; i <= 180; ++i) {
    const double a = pose.theta + scan.angle_min + i * scan.angle_increment;
    const double dx = std::cos(a), dy = std::sin(a);
    double nearest = 29.0;
    for (const Wall& w : cornerWithBranch()) {
      const double ex = w.x1 - w.x0, ey = w.y1 - w.y0, cross = dx * ey - dy * ex;
      if (std::abs(cross) < 1e-12) continue;
      const double t = ((w.x0 - pose.x) * ey - (w.y0 - pose.y) * ex) / cross;
      const double u = ((w.x0 - pose.x) * dy - (w.y0 - pose.y) * dx) / cross;
      if (t > 0.0 && u >= 0.0 && u <= 1.0) nearest = std::min(nearest, t);
    }
    scan.ranges.push_back(static_cast<float>(nearest));
  }
  return scan;
}

/// Along the middle of the corridor, there or back.
std::vector<Pose2> way(bool back) {
  std::vector<Pose2> poses;
  for (int i = 0; i <= 180; ++i) poses.push_back({0.1 * i + 0.05, 0.05, 0.0});
  for (int i = 1; i <= 15; ++i) {  // a quarter of a circle of 2 m around (18, 2)
    const double a = i * kPi / 32;
    poses.push_back({18.05 + 2 * std::sin(a), 2.05 - 2 * std::cos(a), a});
  }
  for (int i = 0; i <= 180; ++i) poses.push_back({20.05, 2.05 + 0.1 * i, kPi / 2});
  if (!back) return poses;
  std::reverse(poses.begin(), poses.end());
  for (Pose2& p : poses) p.theta = hyselam::normalizeAngle(p.theta + kPi);
  return poses;
}

std::vector<DensityObservation> drive(bool back, double look_back) {
  ObservationSensorParams params;
  params.look_back = look_back;
  ObservationSensor sensor(params);
  std::vector<DensityObservation> all;
  double stamp = 0.0;
  for (const Pose2& pose : way(back)) {
    // Every spot is seen often, as by a robot of 0.5 m/s.
    for (int i = 0; i < 3; ++i) {
      const auto more = sensor.add(scanFrom(pose, stamp), pose);
      all.insert(all.end(), more.begin(), more.end());
      stamp += 0.05;
    }
  }
  const auto rest = sensor.finish();
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

/// Root of the mean squared difference between the densities there and back, away from the ends.
double differenceBothWays(WordDensity which) {
  const auto there = drive(false, 3.0), back = drive(true, 3.0);
  double sum = 0.0;
  int n = 0;
  for (const DensityObservation& a : there) {
    if (a.base_in_odom.x < 4.0 || a.base_in_odom.y > 15.0) continue;
    for (const DensityObservation& b : back) {
      if (hyselam::distance(a.base_in_odom, b.base_in_odom) > 0.05) continue;
      const double d =
          which == WordDensity::kFull ? a.full.value() - b.full.value() : a.soft - b.soft;
      sum += d * d;
      ++n;
      break;
    }
  }
  EXPECT_GT(n, 200);
  return std::sqrt(sum / n);
}

DensityObservation at(double way, double density) {
  DensityObservation o;
  o.stamp = way;
  o.base_in_odom = {way, 0.0, 0.0};
  o.soft = density;
  return o;
}

}  // namespace

TEST(ObservationSensor, fullDensitiesAreTheSameInBothDirections) {
  const double soft = differenceBothWays(WordDensity::kSoft);
  const double full = differenceBothWays(WordDensity::kFull);
  EXPECT_GT(soft, 0.01);  // round the corner lies what the robot does not see yet
  EXPECT_LT(full, 0.01);
  EXPECT_LT(full, soft / 3.0);
}

TEST(ObservationSensor, fullDensitiesComeLaterForTheSameSpots) {
  const auto now = drive(false, 0.0), later = drive(false, 3.0);
  ASSERT_EQ(now.size(), later.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_EQ(now[i].stamp, later[i].stamp);
    EXPECT_EQ(now[i].soft, later[i].soft);
    EXPECT_FALSE(now[i].full.has_value());
    EXPECT_TRUE(later[i].full.has_value());
  }
  // 3 m behind the newest one, and in order.
  ObservationSensorParams params;
  params.look_back = 3.0;
  ObservationSensor sensor(params);
  std::size_t told = 0;
  for (const Pose2& pose : way(false)) told += sensor.add(scanFrom(pose, 0.0), pose).size();
  EXPECT_NEAR(static_cast<double>(now.size() - told), 30.0, 1.0);
  EXPECT_EQ(told + sensor.finish().size(), now.size());
}

TEST(ObservationSensor, keepsPendingObservationsWhenTheScanAfterAJumpIsRefused) {
  ObservationSensorParams params;
  params.look_back = 3.0;
  const auto drive = [&](bool refused) {
    ObservationSensor sensor(params);
    std::size_t told = 0;
    for (int i = 0; i < 20; ++i) {
      const Pose2 pose{2.05 + 0.1 * i, 2.05, 0.0};
      told += sensor.add(scanFrom(pose, 0.1 * i), pose).size();
    }
    const Pose2 far{20.05, 12.05, 0.0};
    hyselam::LaserScan bad = scanFrom(far, 3.0);
    bad.ranges.clear();
    if (refused) {
      EXPECT_THROW(sensor.add(bad, far), hyselam::InputError);
    }
    told += sensor.add(scanFrom(far, 3.1), far).size();
    return told + sensor.finish().size();
  };
  EXPECT_EQ(drive(false), 21u);
  EXPECT_EQ(drive(true), 21u);
}

TEST(ObservationSensor, refusesALookBackOutOfRange) {
  ObservationSensorParams params;
  for (double bad : {-1.0, 21.0, std::nan("")}) {
    params.look_back = bad;
    EXPECT_THROW(ObservationSensor{params}, hyselam::ParameterError) << bad;
  }
}

TEST(DensityClasses, hysteresisKeepsTheClassNearItsBounds) {
  const DensityClasses classes = DensityClasses::uniform(4);
  EXPECT_EQ(classes.classOf(0.26, 0, 0.02), 0);
  EXPECT_EQ(classes.classOf(0.28, 0, 0.02), 1);
  EXPECT_EQ(classes.classOf(0.24, 1, 0.02), 1);
  EXPECT_EQ(classes.classOf(0.22, 1, 0.02), 0);
  EXPECT_EQ(classes.classOf(0.99, 3, 0.02), 3);
  EXPECT_EQ(classes.classOf(0.6, 77, 0.02), 2);  // an id that is gone
  for (double d = 0.0; d <= 1.0; d += 0.01) {
    for (int before = 0; before < 4; ++before) {
      EXPECT_EQ(classes.classOf(d, before, 0.0), classes.classOf(d)) << d;
    }
  }
}

TEST(DensityClasses, hysteresisAvoidsWordsFromNoiseAtABound) {
  NgramRecognizerParams params;
  params.min_region = 1;
  const auto words = [&](double hysteresis) {
    params.class_hysteresis = hysteresis;
    NgramRecognizer r(params);
    for (int i = 0; i < 400; ++i) {
      r.add(at(0.1 * i, (i < 200 ? 0.25 : 0.6) + (i % 2 == 0 ? 0.005 : -0.005)));
    }
    r.endRun();
    return r.text().positions();
  };
  EXPECT_GT(words(0.0), 100u);
  EXPECT_EQ(words(0.02), 2u);
}

TEST(LanguageModel, probabilitiesSumToOne) {
  // Sizes that no two of match each other, angles likewise: chances are a distribution.
  LanguageModel model;
  hyselam::Rng rng(5);
  const WordTolerance tolerance{0.2, radians(30)};
  const auto word = [&](int c, int s, int a) {
    return Syllables{c, static_cast<std::uint32_t>(4 << s), static_cast<float>(a * kPi / 2)};
  };
  Syllables before = word(0, 0, 0);
  model.add(before, nullptr);
  for (int i = 0; i < 3000; ++i) {
    const Syllables w = word(static_cast<int>(rng.below(3)), static_cast<int>(rng.below(3)),
                             static_cast<int>(rng.below(2)));
    model.add(w, &before);
    model.addPair(before, w);
    before = w;
  }
  for (bool after : {false, true}) {
    const Syllables* context = after ? &before : nullptr;
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
      for (int s = 0; s < 3; ++s) {
        for (int a = 0; a < 2; ++a) sum += model.chanceOfMatch(word(c, s, a), context, tolerance);
      }
    }
    // In a context each of the 18 leaves one pair out that it takes for its own.
    if (after) {
      EXPECT_GT(sum, 1.0 - 18.0 / 100.0);
      EXPECT_LE(sum, 1.0);
    } else {
      EXPECT_NEAR(sum, 1.0, 0.02);
    }
  }
  EXPECT_NEAR(model.chanceOfMatch(word(1, 1, 1), &before, tolerance), 1.0 / 18, 0.03);
}

TEST(LanguageModel, learnsBigrams) {
  LanguageModel model;
  const WordTolerance tolerance;
  const Syllables a{0, 50, 0.0f}, b{1, 20, 1.5f}, c{0, 200, 0.0f}, d{1, 20, -1.5f};
  const Syllables* before = nullptr;
  for (int i = 0; i < 40; ++i) {
    for (const Syllables* w : {&a, &b, &c, &d}) {
      model.add(*w, before);
      if (before != nullptr) model.addPair(*before, *w);
      before = w;
    }
  }
  EXPECT_GT(model.chanceOfMatch(b, &a, tolerance), 0.9);
  EXPECT_LT(model.chanceOfMatch(d, &a, tolerance), 0.05);
  EXPECT_NEAR(model.chanceOfMatch(b, nullptr, tolerance), 0.25, 0.05);
  // What was never seen is improbable, not impossible.
  EXPECT_GT(model.chanceOfMatch({7, 33, 0.0f}, &a, tolerance), 0.0);
  EXPECT_LT(model.chanceOfMatch({7, 33, 0.0f}, &a, tolerance), 0.01);
}

TEST(LanguageModel, queryTimeDoesNotDependOnTheTextLength) {
  LanguageModel model;
  hyselam::Rng rng(2);
  Syllables before{0, 5, 0.0f};
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < 20000; ++i) {
    const Syllables w{static_cast<int>(rng.below(4)), 5 + rng.below(50), 0.0f};
    model.add(w, &before);
    model.addPair(before, w);
    before = w;
    if (i == LanguageModel::kSample) bytes = model.bytes();
  }
  EXPECT_EQ(model.bytes(), bytes);
}

TEST(MatchConfidence, isHigherForRareWordsThanForCommonOnes) {
  // Two stretches of six words come back: one of corridors that are all alike, one of odd rooms.
  WordLattice text(1);
  ObservationStore observations;
  const WordTolerance tolerance;
  MatchConfidence confidence(text, observations, tolerance, WordDensity::kSoft);
  Position learnt = 0;
  const auto push = [&](Syllables w) {
    text.push(w);
    confidence.learn(learnt++);
  };
  const std::vector<Syllables> common = {{0, 40, 0.0f}, {1, 12, 0.0f}, {0, 41, 0.0f},
                                         {1, 12, 0.0f}, {0, 39, 0.0f}, {1, 13, 0.0f}};
  const std::vector<Syllables> odd = {{2, 8, 1.5f},  {0, 17, 0.0f}, {3, 90, -1.5f},
                                      {1, 55, 0.4f}, {4, 20, 3.0f}, {2, 150, 0.0f}};
  for (const auto& w : odd) push(w);
  for (int i = 0; i < 20; ++i) {
    for (const auto& w : common) push(w);
  }
  const Position end_of_common = text.positions() - 1;
  for (const auto& w : odd) push(w);
  const auto chanceOf = [&](Position newer, Position older) {
    NgramMatch m;
    m.newer = text.realWord(newer);
    m.older = text.realWord(older);
    m.n = 6;
    MatchConfidence fresh = confidence;
    fresh.estimate(m, false);
    EXPECT_LT(m.probability, 0.0);  // not asked for
    return m.chance;
  };
  EXPECT_GT(chanceOf(end_of_common, end_of_common - 6), 0.1);
  EXPECT_LT(chanceOf(text.positions() - 1, 5), 1e-3);
}

TEST(MatchConfidence, keepsTheProbableMatchesInBothDirections) {
  // A way of regions of random densities and lengths, then the same, then the same backwards.
  hyselam::Rng rng(11);
  std::vector<double> densities;
  while (densities.size() < 2000) {
    const double d = rng.uniform(0.1, 0.9);
    const std::size_t length = 10 + rng.below(60);
    for (std::size_t i = 0; i < length; ++i) densities.push_back(d);
  }
  NgramRecognizerParams params;
  params.reverse = true;
  params.matcher.min_n = {3, 3, 3};
  params.min_probability = 0.8;
  NgramRecognizer r(params);
  std::map<Direction, std::size_t> told;
  std::size_t right = 0;
  const auto total = static_cast<double>(densities.size());
  const auto run = [&](int lap) {
    const auto use = [&](const NgramRecognizerUpdate& u) {
      for (const NgramMatch& m : u.matches) {
        ++told[m.direction];
        EXPECT_GE(m.probability, 0.8);
        EXPECT_LE(m.probability, 1.0);
        EXPECT_GE(m.chance, 0.0);
        const double newer = r.observations().pose(r.text().observationBegin(m.newer)).x;
        const double older = r.observations().pose(r.text().observationEnd(m.older) - 1).x;
        const double older_begin = r.observations().pose(r.text().observationBegin(m.older)).x;
        right += std::abs(newer - (m.direction == Direction::kReverse ? older : older_begin)) < 1.0;
      }
    };
    for (std::size_t i = 0; i < densities.size(); ++i) {
      const std::size_t k = lap == 2 ? densities.size() - 1 - i : i;
      DensityObservation o =
          at(0.1 * static_cast<double>(k), densities[k] + rng.uniform(-0.001, 0.001));
      o.stamp = lap * total + static_cast<double>(i);
      use(r.add(o));
    }
    use(r.endRun());
  };
  run(0);
  EXPECT_TRUE(told.empty());
  run(1);
  EXPECT_GT(told[Direction::kSame], 20u);
  run(2);
  EXPECT_GT(told[Direction::kReverse], 20u);
  EXPECT_GE(right, (told[Direction::kSame] + told[Direction::kReverse]) * 9 / 10);
}

TEST(NgramRecognizerParams, improvedOnesAreValid) {
  const NgramRecognizerParams p = NgramRecognizerParams::improved();
  p.validate();
  EXPECT_TRUE(p.needsConfidence());
  EXPECT_FALSE(NgramRecognizerParams{}.needsConfidence());
  EXPECT_EQ(p.matcher.min_n.size(), static_cast<std::size_t>(p.levels));
}

TEST(NgramRecognizerParams, refusesValuesOutOfRange) {
  const auto refused = [](auto change) {
    NgramRecognizerParams p;
    change(p);
    EXPECT_THROW(p.validate(), hyselam::ParameterError);
  };
  refused([](NgramRecognizerParams& p) { p.class_hysteresis = 0.5; });
  refused([](NgramRecognizerParams& p) { p.class_hysteresis = -0.1; });
  refused([](NgramRecognizerParams& p) { p.max_chance = -1.0; });
  refused([](NgramRecognizerParams& p) { p.max_chance = std::nan(""); });
  refused([](NgramRecognizerParams& p) { p.min_probability = 1.1; });
  refused([](NgramRecognizerParams& p) { p.confidence.misfit_floor = 0.0; });
  refused([](NgramRecognizerParams& p) { p.confidence.max_words = 0; });
  refused([](NgramRecognizerParams& p) { p.confidence.bias = std::nan(""); });
}

TEST(Alignment, alignsBackwardsInReverse) {
  ObservationStore store;
  hyselam::Rng rng(4);
  std::vector<double> densities;
  for (int i = 0; i < 200; ++i) densities.push_back(rng.uniform(0.1, 0.9));
  for (int i = 0; i < 200; ++i) store.append(at(0.1 * i, densities[static_cast<std::size_t>(i)]));
  store.startRun();
  for (int i = 199; i >= 0; --i) store.append(at(0.1 * i, densities[static_cast<std::size_t>(i)]));
  // Observation 200 + k is 199 - k. The word 240 .. 279 is 159 .. 120, here cut 3 too far back.
  const auto found = align(store, 240, 156, 40, {}, Direction::kReverse);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->shift, 3);
  EXPECT_LT(found->rms, 1e-4);
}

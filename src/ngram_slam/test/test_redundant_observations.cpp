#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/slam/redundant_observations.hpp"

namespace ngram_slam {
namespace {

constexpr int kPerKeyframe = 3;  // observations

/// Visits along one line: from `begin` to `end` [m], a keyframe each 0.3 m.
class Visits {
 public:
  void add(double begin, double end) {
    state.corpus.observations.startRun();
    const auto run = static_cast<std::uint32_t>(firsts.size());
    firsts.push_back(state.keyframes.size());
    for (double x = begin; x < end; x += 0.1 * kPerKeyframe) {
      SlamKeyframe keyframe;
      keyframe.pose = {x, 0.02 * run, 0.0};
      keyframe.run = run;
      for (int i = 0; i < kPerKeyframe; ++i) {
        DensityObservation o;
        o.base_in_odom = {x + 0.1 * i, 0.0, 0.0};
        o.soft = 0.5;
        state.corpus.observations.append(o);
        state.keyframe_of_observation.push_back(static_cast<std::int32_t>(state.keyframes.size()));
      }
      state.keyframes.push_back(keyframe);
    }
  }

  /// By keyframe: all in one part of the graph, or each visit in one of its own.
  std::vector<int> components() const {
    std::vector<int> out;
    for (const SlamKeyframe& k : state.keyframes) out.push_back(tied ? 0 : static_cast<int>(k.run));
    return out;
  }
  std::vector<bool> none() const { return std::vector<bool>(state.keyframes.size(), false); }
  /// Drops the keyframes of a visit between two places.
  void drop(std::uint32_t run, double begin, double end, std::vector<bool>* dropped) const {
    for (std::size_t k = 0; k < state.keyframes.size(); ++k) {
      const SlamKeyframe& here = state.keyframes[k];
      if (here.run == run && here.pose.x >= begin && here.pose.x < end) (*dropped)[k] = true;
    }
  }
  int kept(std::uint32_t run, const std::vector<bool>& dropped) const {
    const auto forgotten =
        redundantObservations(state, dropped, components(), ObservationRedundancyParams{});
    const ObservationStore& all = state.corpus.observations;
    return static_cast<int>(std::count(forgotten.begin() + all.runBegin(run),
                                       forgotten.begin() + all.runEnd(run), false));
  }
  int made(std::uint32_t run) const {
    const ObservationStore& all = state.corpus.observations;
    return static_cast<int>(all.runEnd(run) - all.runBegin(run));
  }

  SlamState state;
  std::vector<std::size_t> firsts;
  bool tied = true;
};

TEST(RedundantObservations, AreNoneWhereNoKeyframeIsDropped) {
  Visits visits;
  visits.add(0.0, 20.0);
  visits.add(0.0, 20.0);
  EXPECT_EQ(visits.kept(0, visits.none()), visits.made(0));
  EXPECT_EQ(visits.kept(1, visits.none()), visits.made(1));
}

TEST(RedundantObservations, AreThoseOfAVisitThatSawTheSame) {
  Visits visits;
  visits.add(0.0, 20.0);
  visits.add(0.0, 20.0);
  auto dropped = visits.none();
  visits.drop(1, 0.0, 20.0, &dropped);
  EXPECT_EQ(visits.kept(0, dropped), visits.made(0));
  EXPECT_EQ(visits.kept(1, dropped), 0);
}

TEST(RedundantObservations, AreNoneOfAMapThatIsNotTiedToTheOther) {
  Visits visits;
  visits.tied = false;
  visits.add(0.0, 20.0);
  visits.add(0.0, 20.0);
  auto dropped = visits.none();
  visits.drop(1, 0.0, 20.0, &dropped);
  EXPECT_EQ(visits.kept(0, dropped), visits.made(0));
  EXPECT_EQ(visits.kept(1, dropped), visits.made(1));
}

TEST(RedundantObservations, AreNotThoseOfAStretchWhereOnlyThisVisitWas) {
  Visits visits;
  visits.add(0.0, 20.0);
  visits.add(0.0, 30.0);
  auto dropped = visits.none();
  visits.drop(1, 0.0, 20.0, &dropped);
  EXPECT_NEAR(visits.kept(1, dropped), 100, kPerKeyframe);
  // Nor if their keyframes are dropped.
  visits.drop(1, 0.0, 30.0, &dropped);
  EXPECT_NEAR(visits.kept(1, dropped), 90, 2 * kPerKeyframe);
}

TEST(RedundantObservations, AreNewLooksHereAndThereButNoLongStretchOfThem) {
  Visits visits;
  visits.add(0.0, 60.0);
  visits.add(0.0, 60.0);
  auto dropped = visits.none();
  visits.drop(1, 0.0, 60.0, &dropped);
  for (std::size_t k = visits.firsts[1]; k < dropped.size(); ++k) {
    const double x = visits.state.keyframes[k].pose.x;
    const bool is_new_look = std::fmod(x, 10.0) < 0.5;  // here and there
    const bool is_changed = x > 30.0 && x < 40.0;       // all but a keyframe
    if (is_new_look || (is_changed && std::abs(x - 35.0) > 0.2)) dropped[k] = false;
  }
  EXPECT_NEAR(visits.kept(1, dropped), 100, 4 * kPerKeyframe);
}

TEST(RedundantObservations, NoPlaceLosesItsLastOnes) {
  // The oldest visit's keyframes go as later ones saw other things, whose words had been forgotten.
  Visits visits;
  visits.add(0.0, 30.0);
  visits.add(20.0, 30.0);
  auto dropped = visits.none();
  visits.drop(0, 0.0, 30.0, &dropped);
  EXPECT_NEAR(visits.kept(0, dropped), 190, 3 * kPerKeyframe);
  EXPECT_EQ(visits.kept(1, dropped), visits.made(1));
}

TEST(RedundantObservations, LeaveSomeAtEachPlaceWhateverIsDropped) {
  hyselam::Rng rng(7);
  for (int round = 0; round < 20; ++round) {
    Visits visits;
    for (int run = 0; run < 6; ++run) visits.add(rng.uniform(0.0, 10.0), rng.uniform(20.0, 40.0));
    auto dropped = visits.none();
    for (std::size_t k = 0; k < dropped.size(); ++k) dropped[k] = rng.below(4) > 0;
    const auto forgotten = redundantObservations(visits.state, dropped, visits.components(),
                                                 ObservationRedundancyParams{});
    for (const SlamKeyframe& k : visits.state.keyframes) {
      // Those of a visit may have gone as another one's near them were there, and so on.
      constexpr double kReach = 6 * 1.0;
      bool found = false;
      for (std::size_t i = 0; i < forgotten.size() && !found; ++i) {
        const auto of = static_cast<std::size_t>(visits.state.keyframe_of_observation[i]);
        found = !forgotten[i] && distance(visits.state.keyframes[of].pose, k.pose) < kReach;
      }
      EXPECT_TRUE(found) << "round " << round << ", " << k.pose.x << " m";
    }
  }
}

}  // namespace
}  // namespace ngram_slam

// Maps of several sessions become one where they show the same places, and only there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/testing/files.hpp"
#include "hyselam_sim/data.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/map_merging.hpp"
#include "ngram_slam/slam/map_ties.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "ngram_slam/slam/state_parts.hpp"
#include "signature_loop.hpp"
#include "visits.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

struct Visits : ThreeVisits {
  SlamState first_map = mapOf(first, 0.0, 0.6), second_map = mapOf(second, 0.3, 1.0),
            other_map = mapOf(other, 0.0, 0.6);
};
const Visits& visits() {
  static const Visits v;
  return v;
}

const MergedMaps& merged() {
  static const MergedMaps m = mergeMaps({{"first", visits().first_map},
                                         {"other", visits().other_map},
                                         {"second", visits().second_map}});
  return m;
}

const MergedMap& mapWith(std::size_t session) {
  for (const MergedMap& map : merged().maps) {
    for (const MergedPart& part : map.parts) {
      if (part.session == session) return map;
    }
  }
  throw std::runtime_error("no map holds the session");
}

std::string bytesOf(const SlamState& state) {
  const hyselam::testing::TemporaryDirectory d;
  SlamStateFile::save(d / "s.state", state);
  return hyselam::testing::fileBytes(d / "s.state");
}

TEST(MapMerging, MakesOneMapOfOneBuilding) {
  ASSERT_EQ(merged().maps.size(), 2U);
  const MergedMap& map = mapWith(0);
  ASSERT_EQ(map.parts.size(), 2U);
  EXPECT_EQ(map.parts[1].session, 2U);
  EXPECT_EQ(map.parts[0].runs, std::vector<std::uint32_t>{0});
  EXPECT_EQ(map.parts[1].runs, std::vector<std::uint32_t>{1});
  EXPECT_EQ(map.parts[0].trajectory.size(), visits().first_map.scans.size());
  EXPECT_EQ(map.parts[1].trajectory.size(), visits().second_map.scans.size());
  // In the frame of the first robot, whose odometry is that of the truth.
  const Pose2 origin = hyselam::poseAt(visits().first.ground_truth, 0.0, 1.0)->inverse();
  double worst = 0.0;
  for (const MergedPart& part : map.parts) {
    const hyselam::RobotLog& log = part.session == 0 ? visits().first : visits().second;
    for (const hyselam::StampedPose2& p : part.trajectory) {
      const Pose2 true_pose = origin * *hyselam::poseAt(log.ground_truth, p.stamp, 1.0);
      const Pose2 pose = map.parts[0].trajectory.front().pose.inverse() * p.pose;
      worst = std::max(worst, distance(pose, true_pose));
    }
  }
  EXPECT_LT(worst, 0.5);
}

TEST(MapMerging, TellsWhoMetWhom) {
  ASSERT_FALSE(merged().meetings.empty());
  const MapMeeting& m = merged().meetings.back();
  EXPECT_EQ(m.a, 0U);
  EXPECT_EQ(m.b, 2U);
  EXPECT_GE(m.far_loops, 3);
  EXPECT_GE(m.near_loops, 10);
  EXPECT_GT(m.fit, 0.85);
  for (const MapMeeting& other : merged().meetings) {
    if (other.a == 1 || other.b == 1) {
      EXPECT_EQ(other.far_loops + other.near_loops, 0);
    }
  }
  EXPECT_EQ(merged().counters.ties, 1);
  EXPECT_EQ(merged().counters.ties_withdrawn, 0);
  EXPECT_TRUE(merged().left_out.empty());
  EXPECT_TRUE(merged().doubtful.empty());
}

TEST(MapMerging, EachMapIsComparedWithEachOther) {
  // The second is tied to the first before the third comes: it is compared with that one all the
  // same.
  const hyselam::RobotLog third = visit(5, 6, {-3.0, 1.0, -1.0});
  const MergedMaps m = mergeMaps({{"first", visits().first_map},
                                  {"third", mapOf(third, 0.35, 0.6)},
                                  {"second", visits().second_map}});
  ASSERT_EQ(m.maps.size(), 1U);
  ASSERT_EQ(m.meetings.size(), 3U);
  for (const MapMeeting& one : m.meetings) EXPECT_GE(one.near_loops, 5) << one.a << " " << one.b;
}

/// What SLAM has of a log when the robot has driven so far [m], once each.
std::vector<SlamState> stages(const hyselam::RobotLog& log, double from,
                              const std::vector<double>& lengths) {
  std::vector<SlamState> states;
  SlamEngine engine;
  const auto n = static_cast<double>(log.scans.size());
  for (auto i = static_cast<std::size_t>(from * n); states.size() < lengths.size(); ++i) {
    engine.add(log.scans.at(i), *hyselam::poseAt(log.odometry, log.scans.at(i).stamp, 1.0));
    while (const auto job = engine.takeJob()) engine.apply(runJob(*job));
    if (engine.keyframes().back().path_length >= lengths[states.size()]) {
      states.push_back(engine.state());
    }
  }
  return states;
}

hyselam::RobotLog drawn(const std::string& name, std::uint64_t seed) {
  using namespace hyselam_sim;
  return simulate(loadFloorPlan(planFile(name)), loadRoute(routeFile(name)), seed).log;
}

// Robots that have begun know little: what looks the same for as far as one segment reaches is no
// tie, in one building or in two.
TEST(MapMerging, TiesNothingWhileTooLittleIsKnown) {
  const std::vector<double> lengths{5.0, 10.0, 50.0};
  const auto first = stages(visits().first, 0.0, lengths);
  const auto second = stages(visits().second, 0.3, lengths);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const MergedMaps m = mergeMaps({{"first", first[i]}, {"second", second[i]}});
    // They met after 40 m.
    EXPECT_EQ(m.maps.size(), lengths[i] < 40.0 ? 2U : 1U) << lengths[i];
  }
}

TEST(MapMerging, NeverJoinsTwoBuildingsOfAlikeCorridors) {
  const auto a = stages(drawn("mcl_a", 2), 0.0, {4, 6, 8, 12, 22});
  const auto b = stages(drawn("mcl_b", 3), 0.0, {22, 24, 26, 30});
  const std::vector<std::pair<std::size_t, std::size_t>> told{
      {0, 0}, {4, 0}, {1, 1}, {2, 2}, {3, 3}};
  for (const auto& [i, k] : told) {
    const MergedMaps m = mergeMaps({{"a", a[i]}, {"b", b[k]}});
    EXPECT_EQ(m.maps.size(), 2U) << i << " " << k;
    EXPECT_GT(m.counters.verified, 2) << "nothing looked alike";
  }
}

TEST(MapMerging, LeavesAnotherBuildingApart) {
  const MergedMap& map = mapWith(1);
  ASSERT_EQ(map.parts.size(), 1U);
  EXPECT_EQ(bytesOf(map.state).size(), bytesOf(visits().other_map).size());
  ASSERT_EQ(map.state.keyframes.size(), visits().other_map.keyframes.size());
  for (std::size_t k = 0; k < map.state.keyframes.size(); ++k) {
    EXPECT_EQ(distance(map.state.keyframes[k].pose, visits().other_map.keyframes[k].pose), 0.0);
  }
}

TEST(MapMerging, GivesTheSameBytesWithThreads) {
  MapMergingParams params;
  params.threads = 3;
  const std::vector<MapSession> both{{"first", visits().first_map},
                                     {"second", visits().second_map}};
  const MergedMaps once = mergeMaps(both), again = mergeMaps(both, params);
  ASSERT_EQ(once.maps.size(), 1U);
  ASSERT_EQ(again.maps.size(), 1U);
  EXPECT_TRUE(bytesOf(again.maps[0].state) == bytesOf(once.maps[0].state));
}

TEST(MapMerging, GoesOnWithWhatItMerged) {
  // What is merged already meets itself no more, and an engine goes on with it.
  const MergedMaps again = mergeMaps({{"both", mapWith(0).state}, {"other", visits().other_map}});
  EXPECT_EQ(again.maps.size(), 2U);
  EXPECT_EQ(again.counters.ties, 0);
  EXPECT_EQ(again.counters.near_tried, 0);
  SlamEngine engine(SlamParams{}, mapWith(0).state);
  engine.add(visits().first.scans.front(), visits().first.odometry.front().pose);
  EXPECT_EQ(engine.keyframes().back().run, 2U);
  EXPECT_TRUE(engine.connections().connected(0, 1));
}

TEST(MapMerging, LeavesOutWhatIsNoSessionOfItsOwn) {
  SlamState broken = visits().first_map;
  broken.odometry.front().to = -5;
  const auto part = mapOf(visits().first, 0.0, 0.3);
  const MergedMaps m = mergeMaps({{"first", visits().first_map},
                                  {"empty", {}},
                                  {"broken", broken},
                                  {"again", visits().first_map},
                                  {"part", part}});
  ASSERT_EQ(m.maps.size(), 1U);
  ASSERT_EQ(m.maps[0].parts.size(), 1U);
  EXPECT_EQ(m.maps[0].parts[0].session, 0U);
  ASSERT_EQ(m.left_out.size(), 4U);
  EXPECT_EQ(m.left_out[0].name, "empty");
  EXPECT_EQ(m.left_out[0].reason, "holds no keyframes");
  EXPECT_EQ(m.left_out[1].name, "broken");
  EXPECT_NE(m.left_out[1].reason.find("an edge lacks its keyframes"), std::string::npos);
  for (const std::size_t i : {2U, 3U}) {
    EXPECT_EQ(m.left_out[i].name, i == 2 ? "again" : "part");
    EXPECT_NE(m.left_out[i].reason.find("first"), std::string::npos) << m.left_out[i].reason;
    EXPECT_NE(m.left_out[i].reason.find("recording"), std::string::npos) << m.left_out[i].reason;
  }
  EXPECT_TRUE(mergeMaps({{"empty", {}}}).maps.empty());
}

TEST(MapMerging, TellsAnotherLaser) {
  SlamState narrow = visits().other_map;
  for (SlamKeyframe& k : narrow.keyframes) {
    hyselam::LaserScan scan = *k.scan;
    scan.ranges.resize(scan.ranges.size() / 3);
    k.scan = std::make_shared<const hyselam::LaserScan>(scan);
  }
  const MergedMaps m = mergeMaps({{"narrow", narrow}, {"first", visits().first_map}});
  ASSERT_EQ(m.doubtful.size(), 1U);
  const bool first_is_larger = visits().first_map.keyframes.size() > narrow.keyframes.size();
  EXPECT_EQ(m.doubtful[0].name, first_is_larger ? "narrow" : "first");
  EXPECT_NE(m.doubtful[0].reason.find("degrees"), std::string::npos);
}

TEST(MapMerging, RefusesImpossibleParameters) {
  MapMergingParams params;
  params.threads = 0;
  EXPECT_THROW(mergeMaps({}, params), hyselam::ParameterError);
  params = {};
  params.max_rival = 1.5;
  EXPECT_THROW(mergeMaps({}, params), hyselam::ParameterError);
}

// ---- parts

TEST(StateParts, JoinedAndTakenApartAreTheSame) {
  const std::vector<SlamState> given{visits().first_map, visits().other_map};
  const SlamState joined = joinedStates(given);
  EXPECT_EQ(joined.error(), nullptr);
  EXPECT_EQ(runsOf(joined), 2U);
  EXPECT_EQ(joined.counters.scans, given[0].counters.scans + given[1].counters.scans);
  for (const std::size_t run : {0U, 1U}) {
    SlamState part = partOfState(joined, {run == 0, run == 1});
    part.counters = given[run].counters;
    ASSERT_EQ(part.keyframes.size(), given[run].keyframes.size());
    for (std::size_t k = 0; k < part.keyframes.size(); ++k) {
      EXPECT_NEAR(part.keyframes[k].path_length, given[run].keyframes[k].path_length, 1e-6);
      part.keyframes[k].path_length = given[run].keyframes[k].path_length;
    }
    EXPECT_TRUE(bytesOf(part) == bytesOf(given[run]));
  }
  EXPECT_TRUE(partOfState(joined, {}).keyframes.empty());
}

TEST(StateParts, NumberRunsThatAreGoneOnce) {
  SlamState gap = visits().first_map;
  for (std::size_t k = gap.keyframes.size() / 2; k < gap.keyframes.size(); ++k) {
    gap.keyframes[k].run = 7;
  }
  const SlamState joined = joinedStates({gap, visits().other_map});
  EXPECT_EQ(runsOf(joined), 3U);
  SlamState disordered = gap;
  disordered.keyframes.front().run = 9;
  EXPECT_THROW(joinedStates({disordered}), hyselam::InputError);
}

// ---- ties

/// Two runs of 60 keyframes a metre apart; what is measured says that the second lies at `where`.
struct TwoRuns {
  std::vector<SlamKeyframe> keyframes;
  TwoRuns() : keyframes(120) {
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
      keyframes[k].run = k < 60 ? 0 : 1;
      keyframes[k].pose = {static_cast<double>(k % 60), 0.0, 0.0};
      keyframes[k].path_length = static_cast<double>(k);
    }
  }
  SlamLoop loop(int older, int newer, const Pose2& where) const {
    SlamLoop l;
    l.older = older;
    l.newer = 60 + newer;
    l.measured = between(keyframes[static_cast<std::size_t>(older)].pose,
                         where * keyframes[static_cast<std::size_t>(l.newer)].pose);
    l.source = LoopSource::kSignature;
    l.far = true;
    l.inlier_ratio = 0.8;
    l.fit = 0.97;
    return l;
  }
};

TEST(MapTies, TheOneWithMostSupportIsTold) {
  const TwoRuns runs;
  const Pose2 right{10.0, 3.0, 0.0}, wrong{-20.0, 0.0, 1.0};
  std::vector<SlamLoop> loops;
  for (const int i : {40, 42, 44}) loops.push_back(runs.loop(i - 20, i, wrong));
  for (const int i : {2, 4, 6, 8, 10, 12, 14, 16}) {
    loops.push_back(runs.loop(i + 10, i, right));
  }
  const auto tie = bestTie(loops, runs.keyframes, RunConnections{}, LoopParams{}, 0.5);
  ASSERT_TRUE(tie);
  EXPECT_EQ(tie->loops.size(), 8U);
  EXPECT_NEAR(tie->support, 8 * 0.8, 1e-9);
  EXPECT_NEAR(tie->rival, 3 * 0.8, 1e-9);
  for (const SlamLoop& l : tie->loops) EXPECT_LT(l.newer, 60 + 20);
  // As many say the other.
  for (const int i : {46, 48, 50, 52, 54}) loops.push_back(runs.loop(i - 20, i, wrong));
  EXPECT_FALSE(bestTie(loops, runs.keyframes, RunConnections{}, LoopParams{}, 0.5));
}

TEST(MapTies, TwoLoopsAreTooFew) {
  const TwoRuns runs;
  const Pose2 where{10.0, 3.0, 0.0};
  std::vector<SlamLoop> loops{runs.loop(12, 2, where), runs.loop(15, 5, where)};
  EXPECT_FALSE(bestTie(loops, runs.keyframes, RunConnections{}, LoopParams{}, 0.5));
  loops.push_back(runs.loop(18, 8, where));
  EXPECT_TRUE(bestTie(loops, runs.keyframes, RunConnections{}, LoopParams{}, 0.5));
  EXPECT_FALSE(bestTie({}, runs.keyframes, RunConnections{}, LoopParams{}, 0.5));
}

TEST(MapTies, RunsOfTwoMapsThatCameInTurnContradictEachOther) {
  // Runs 0 and 2 are one map, run 1 is another one: between 1 and 2 the older end is in that one.
  std::vector<SlamKeyframe> keyframes(180);
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    keyframes[k].run = static_cast<std::uint32_t>(k / 60);
    keyframes[k].pose = {static_cast<double>(k % 60), 0.0, 0.0};
    keyframes[k].path_length = static_cast<double>(k);
  }
  RunConnections connections;
  connections.connect(0, 2);
  const auto loop = [&](int older, int newer, const Pose2& measured) {
    SlamLoop l = signatureLoop(older, newer);
    l.measured = measured;
    return l;
  };
  // Where the map of run 1 lies in that of 0 and 2.
  const auto loopsThatSay = [&](const Pose2& where) {
    std::vector<SlamLoop> loops;
    for (const int i : {2, 5, 8, 11}) {
      const Pose2 in_one = keyframes[static_cast<std::size_t>(60 + i)].pose;
      loops.push_back(
          loop(i, 60 + i, between(keyframes[static_cast<std::size_t>(i)].pose, where * in_one)));
    }
    return loops;
  };
  const Pose2 right{3.0, 2.0, 0.3}, wrong{-20.0, 9.0, 2.0};
  std::vector<SlamLoop> loops = loopsThatSay(right);
  const auto inTurn = [&](const Pose2& where) {
    std::vector<SlamLoop> turned;
    for (const int i : {2, 5, 8, 11}) {
      turned.push_back(loop(60 + i, 120 + i,
                            between(where * keyframes[static_cast<std::size_t>(60 + i)].pose,
                                    keyframes[static_cast<std::size_t>(120 + i)].pose)));
    }
    return turned;
  };
  for (const bool agree : {true, false}) {
    std::vector<SlamLoop> all = loops;
    for (const SlamLoop& l : inTurn(agree ? right : wrong)) all.push_back(l);
    const auto tie = bestTie(all, keyframes, connections, LoopParams{}, 0.5);
    ASSERT_EQ(tie.has_value(), agree);
    if (tie) {
      EXPECT_NEAR(tie->support, 8 * 0.8, 1e-9);
    }
  }
}

TEST(MapTies, NoLoopIsForgottenAmongMany) {
  TwoRuns runs;
  runs.keyframes.resize(1200);
  for (std::size_t k = 120; k < runs.keyframes.size(); ++k) {
    runs.keyframes[k].run = 1;
    runs.keyframes[k].pose = {static_cast<double>(k - 60), 0.0, 0.0};
    runs.keyframes[k].path_length = static_cast<double>(k);
  }
  const Pose2 right{10.0, 3.0, 0.0};
  std::vector<SlamLoop> loops;
  for (const int i : {2, 4, 6, 8, 10, 12, 14, 16, 18, 20})
    loops.push_back(runs.loop(i + 10, i, right));
  for (int i = 0; i < 500; ++i) {  // far from them, each says another thing
    loops.push_back(runs.loop(i % 60, 120 + 2 * i, {7.0 * (i % 31), -11.0 * (i % 17), 0.7 * i}));
  }
  const auto tie = bestTie(loops, runs.keyframes, RunConnections{}, LoopParams{}, 1.0);
  ASSERT_TRUE(tie);
  EXPECT_EQ(tie->loops.size(), 10U);
}

TEST(GraphPathLengths, WithinAReachAreThoseOfTheWholeSearch) {
  GraphPathLengths graph;
  for (int k = 0; k < 50; ++k) graph.addEdge(k, k + 1, 0.7 + 0.01 * k);
  graph.addEdge(3, 40, 0.5);
  const std::vector<double> all = graph.from(10);
  const auto near = graph.within(10, 8.0);
  std::size_t expected = 0;
  for (const double length : all) expected += length <= 8.0 ? 1 : 0;
  EXPECT_EQ(near.size(), expected);
  for (const auto& [k, length] : near) {
    EXPECT_NEAR(length, all[static_cast<std::size_t>(k)], 1e-9);
    EXPECT_LE(length, 8.0);
  }
}

}  // namespace
}  // namespace ngram_slam

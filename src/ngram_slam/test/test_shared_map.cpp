// Robots that map at the same time tell their graphs part by part and get one map.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/ros/shared_map_messages.hpp"
#include "ngram_slam/ros/shared_map_parameters.hpp"
#include "ngram_slam/ros/slam_graph_messages.hpp"
#include "ngram_slam/slam/shared_map.hpp"
#include "visits.hpp"
#include "written_parameters.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

const ThreeVisits& logs() {
  static const ThreeVisits l;
  return l;
}

/// As by the service: through its messages.
GraphPart answerOf(const SlamEngine& engine, const std::string& map,
                   const GraphQuestion& question) {
  hyselam_msgs::SlamGraph::Request request;
  toMsg(question, &request);
  hyselam_msgs::SlamGraph::Response response;
  toMsg(newGraphPart(engine, map, fromMsg(request)), &response);
  return fromMsg(response, "robot");
}

/// Asks until all is told; returns in how many parts.
int tell(const SlamEngine& engine, const std::string& map, std::uint32_t at_once, ToldGraph* told) {
  for (int parts = 1;; ++parts) {
    GraphPart part = answerOf(engine, map, told->question(at_once));
    const bool complete = part.complete;
    told->add(std::move(part), "robot");
    if (complete) return parts;
  }
}

void tell(const SlamEngine& engine, const std::string& map, std::size_t robot, SharedMap* shared) {
  for (bool complete = false; !complete;) {
    GraphPart part = answerOf(engine, map, shared->question(robot, 70));
    complete = part.complete;
    shared->add(robot, std::move(part));
  }
}

void merge(SharedMap* shared) {
  auto work = shared->takeWork();
  ASSERT_TRUE(work);
  const MergedMaps merged = SharedMap::merge(&*work, shared->params().merging);
  shared->apply(*work, merged);
}

void expectSame(const SlamState& told, const SlamEngine& engine) {
  ASSERT_EQ(told.keyframes.size(), engine.keyframes().size());
  for (std::size_t k = 0; k < told.keyframes.size(); ++k) {
    const SlamKeyframe &a = told.keyframes[k], &b = engine.keyframes()[k];
    EXPECT_EQ(distance(a.pose, b.pose), 0.0);
    EXPECT_EQ(a.pose.theta, b.pose.theta);
    EXPECT_EQ(a.run, b.run);
    EXPECT_EQ(a.path_length, b.path_length);
    EXPECT_EQ(a.scan->ranges, b.scan->ranges);
    EXPECT_EQ(a.points->size(), b.points->size());
  }
  ASSERT_EQ(told.odometry.size(), engine.odometry().size());
  for (std::size_t i = 0; i < told.odometry.size(); ++i) {
    EXPECT_EQ(told.odometry[i].to, engine.odometry()[i].to);
    EXPECT_EQ(told.odometry[i].information, engine.odometry()[i].information);
  }
  ASSERT_EQ(told.loops.size(), engine.loops().size());
  for (std::size_t i = 0; i < told.loops.size(); ++i) {
    EXPECT_EQ(told.loops[i].newer, engine.loops()[i].newer);
    EXPECT_EQ(told.loops[i].weight, engine.loops()[i].weight);
    EXPECT_EQ(told.loops[i].source, engine.loops()[i].source);
  }
}

// ---- parameters

SharedMapServerParams load(const Values& values) {
  return loadFrom(loadSharedMapParams, values);
}

TEST(SharedMapParameters, RefusesWhatCannotBe) {
  EXPECT_EQ(load({{"robots", "a  b/c /d"}}).names(), (std::vector<std::string>{"a", "b/c", "/d"}));
  for (const char* robots : {"", "a", "a a", "a 7b", "a b-c"}) {
    EXPECT_THROW(load({{"robots", robots}}), hyselam::ParameterError) << robots;
  }
  EXPECT_THROW(load({{"max_load", 0.0}}), hyselam::ParameterError);
  EXPECT_THROW(load({{"merging/max_rival", 2.0}}), hyselam::ParameterError);
  EXPECT_THROW(load({{"global_frame_id", ""}}), hyselam::ParameterError);
  EXPECT_EQ(load({{"merging/first_candidates", 5}}).shared.merging.first_candidates, 5);
}

TEST(SharedMapParameters, ReadmeHasThemAll) {
  const std::string readme = written("README.md");
  const std::string section = readme.substr(readme.find("## SharedMap"));
  const auto all = defaultsOf(loadSharedMapParams);
  EXPECT_GT(all.size(), 15U);
  for (const auto& [name, value] : all) {
    if (name.find('/') != std::string::npos) continue;  // in docs/parameters.md
    EXPECT_NE(section.find("| `" + name + "` | " + value + " |"), std::string::npos)
        << name << " = " << value;
  }
}

// ---- the graph told in parts

TEST(ToldGraph, IsThatOfTheEngineWhileItGoesOn) {
  SlamEngine engine;
  ToldGraph told;
  EXPECT_EQ(tell(engine, "m", 50, &told), 1);  // nothing yet
  EXPECT_EQ(tell(engine, "m", 50, &told), 1);
  EXPECT_TRUE(told.state().keyframes.empty());
  for (double part = 0.0; part < 0.95; part += 0.2) {
    drive(logs().first, part, part + 0.2, &engine);
    EXPECT_GT(tell(engine, "m", 20, &told), 1);
    expectSame(told.state(), engine);
  }
  EXPECT_GT(engine.revision(), 0);                                            // poses had moved
  EXPECT_FALSE(told.add(answerOf(engine, "m", told.question(50)), "robot"));  // nothing is new
  // Only what is new is told.
  const GraphPart part = answerOf(engine, "m", told.question(0));
  EXPECT_TRUE(part.keyframes.empty() && part.poses.empty() && part.loops.empty());
}

TEST(ToldGraph, AsksAgainForWhatWasLost) {
  SlamEngine engine;
  drive(logs().first, 0.0, 0.2, &engine);
  ToldGraph told;
  told.add(answerOf(engine, "m", told.question(10)), "robot");
  EXPECT_TRUE(told.state().keyframes.empty());  // not complete
  answerOf(engine, "m", told.question(10));     // which never arrives
  drive(logs().first, 0.2, 0.25, &engine);
  tell(engine, "m", 10, &told);
  expectSame(told.state(), engine);
  // One that comes twice is refused, and nothing of it stays.
  const GraphPart twice = answerOf(engine, "m", GraphQuestion{"m", 10, 0, 10});
  EXPECT_TRUE(told.add(answerOf(engine, "n", told.question(0)), "robot"));
  EXPECT_THROW(told.add(twice, "robot"), hyselam::InputError);
  tell(engine, "n", 0, &told);
  expectSame(told.state(), engine);
}

TEST(ToldGraph, BeginsAnewWithAnotherMap) {
  SlamEngine engine, another;
  drive(logs().first, 0.0, 0.2, &engine);
  drive(logs().first, 0.3, 0.5, &another);
  ToldGraph told;
  tell(engine, "m", 10, &told);
  tell(another, "n", 10, &told);
  EXPECT_EQ(told.map(), "n");
  expectSame(told.state(), another);
}

TEST(ToldGraph, RefusesWhatCannotBe) {
  SlamEngine engine;
  drive(logs().first, 0.0, 1.0, &engine);
  ASSERT_FALSE(engine.loops().empty());
  using Response = hyselam_msgs::SlamGraph::Response;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(Response*)>>> wrong = {
      {"map: has no name", [](Response* r) { r->map.clear(); }},
      {"first: is 3", [](Response* r) { r->first = 3; }},
      {"new keyframe 2: holds a number that is not finite",
       [&](Response* r) { r->new_keyframes[2].pose.x = kNan; }},
      {"keyframe 4: all beams have one bearing",
       [](Response* r) { r->new_keyframes[4].angle_increment = 0.0; }},
      {"keyframe 4: the laser is more than 5 m",
       [](Response* r) { r->new_keyframes[4].laser.x = 7.0; }},
      {"belongs to an earlier run", [](Response* r) { r->new_keyframes[0].run = 9; }},
      {"edge 1: holds a number", [&](Response* r) { r->odometry[1].measured.theta = kNan; }},
      {"edge 0: holds an information matrix",
       [](Response* r) { r->odometry[0].information[0] = -1.0; }},
      {"edge 0: names a keyframe", [](Response* r) { r->odometry[0].from = 4000000000U; }},
      {"an edge lacks its keyframes", [](Response* r) { r->odometry[0].from = 100000; }},
      {"a loop lacks its keyframes", [](Response* r) { r->loops[0].edge.to = 100000; }},
      {"loop 0: has an unknown source", [](Response* r) { r->loops[0].source = 7; }},
      {"loop 0: holds a part", [](Response* r) { r->loops[0].weight = 1.5; }},
      {"poses: are ", [](Response* r) { r->poses.pop_back(); }},
      {"poses: of another version", [](Response* r) { r->poses.clear(); }},
      {"pose 7: holds a number", [&](Response* r) { r->poses[7].y = kNan; }},
      {"10000 km", [](Response* r) { r->poses[7].y = 1e12; }},
      {"settled cells: arrays", [](Response* r) { r->settled.visits.push_back(1); }},
      {"settled", [](Response* r) {
         r->settled.keyframes = {100000};
         r->settled.centers.resize(1);
         r->settled.log_odds = {1.0F};
         r->settled.visits = r->settled.changes = {1};
         r->settled.runs = {0};
         r->settled.cell = 0.05;
       }}};
  for (const auto& [reason, damage] : wrong) {
    ToldGraph told;
    Response response;
    toMsg(newGraphPart(engine, "m", told.question(0)), &response);
    damage(&response);
    try {
      told.add(fromMsg(response, "robot"), "robot");
      ADD_FAILURE() << reason << ": not refused";
    } catch (const hyselam::InputError& e) {
      EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).rfind("robot", 0), 0U) << e.what();
    }
    EXPECT_TRUE(told.state().keyframes.empty());
    tell(engine, "m", 0, &told);  // and all is well again
    expectSame(told.state(), engine);
  }
}

// ---- the shared map

/// How far a robot's newest keyframe is from the truth in the frame of the first robot.
double errorOf(const SharedMap& shared, std::size_t robot, const SlamEngine& engine,
               const hyselam::RobotLog& log) {
  const auto where = shared.robots()[robot].map_in_shared;
  if (!where) return std::numeric_limits<double>::infinity();
  const Pose2 origin = hyselam::poseAt(logs().first.ground_truth, 0.0, 1.0)->inverse();
  const SlamKeyframe& newest = engine.keyframes().back();
  return distance(*where * newest.pose,
                  origin * *hyselam::poseAt(log.ground_truth, newest.stamp, 1.0));
}

/// Three robots, two of them in one building.
struct Robots {
  SlamEngine first, second, other;
  SharedMap apart{{"a", "b", "c"}}, merged{{"a", "b", "c"}};
  Robots() {
    drive(logs().first, 0.0, 0.5, &first);
    drive(logs().second, 0.3, 0.8, &second);
    drive(logs().other, 0.0, 0.4, &other);
    tell(second, "b1", 1, &apart);
    tell(first, "a1", 0, &apart);
    tell(other, "c1", 2, &apart);
    merged = apart;
    merge(&merged);
  }
};
const Robots& robots() {
  static const Robots r;
  return r;
}

std::string textOf(const SharedMap& shared) {
  const std::vector<RobotAnswers> answers{
      {"a", "a/map", ""}, {"b", "b/map", ""}, {"c", "", "gone"}};
  return sharedMapStatusMsg(answers, shared.robots(), {}).text;
}

TEST(SharedMap, IsOneOfRobotsInOneBuilding) {
  const Robots& r = robots();
  // Before anything is merged it is that of one robot.
  EXPECT_EQ(textOf(r.apart),
            "the map is that of b; a and c are not recognized in it; c does not answer");
  EXPECT_EQ(r.apart.state().robot_of_run, std::vector<std::size_t>{1});
  SharedMap shared = r.merged;
  EXPECT_FALSE(shared.takeWork());  // nothing is new
  const auto robots = shared.robots();
  ASSERT_TRUE(robots[0].map_in_shared && robots[1].map_in_shared);
  EXPECT_FALSE(robots[2].map_in_shared);
  EXPECT_EQ(textOf(shared), "a and b are in one map; c is not recognized in it; c does not answer");
  // The frame is that of the robot which was there first.
  EXPECT_LT(std::hypot(robots[1].map_in_shared->x, robots[1].map_in_shared->y), 0.5);
  EXPECT_GT(robots[0].ties, 10);
  EXPECT_EQ(robots[0].ties, robots[1].ties);
  EXPECT_EQ(robots[2].ties, 0);
  const SharedMapState state = shared.state();
  EXPECT_EQ(state.robot_of_run, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(state.state.keyframes.size(), r.first.keyframes().size() + r.second.keyframes().size());
  EXPECT_EQ(state.state.error(), nullptr);
  EXPECT_EQ(state.state.loops.size(), r.first.loops().size() + r.second.loops().size() +
                                          static_cast<std::size_t>(robots[0].ties));
}

TEST(SharedMap, GoesOnBetweenMergings) {
  const Robots& r = robots();
  SharedMap shared = r.merged;
  SlamEngine second;  // the same one
  drive(logs().second, 0.3, 0.8, &second);
  const Pose2 to_first = shared.robots()[0].map_in_shared->inverse();
  const auto errorNow = [&] {
    const Pose2 origin = hyselam::poseAt(logs().first.ground_truth, 0.0, 1.0)->inverse();
    const SlamKeyframe& newest = second.keyframes().back();
    return distance(to_first * *shared.robots()[1].map_in_shared * newest.pose,
                    origin * *hyselam::poseAt(logs().second.ground_truth, newest.stamp, 1.0));
  };
  EXPECT_LT(errorNow(), 0.5);
  const std::size_t before = shared.state().state.keyframes.size();
  drive(logs().second, 0.8, 1.0, &second);
  tell(second, "b1", 1, &shared);
  EXPECT_LT(errorNow(), 0.5);
  EXPECT_GT(shared.state().state.keyframes.size(), before + 20);
  const std::size_t all = shared.state().state.keyframes.size();
  // The frame stays where it was when all is merged anew.
  const Pose2 frame = *shared.robots()[1].map_in_shared * second.keyframes().front().pose;
  merge(&shared);
  EXPECT_LT(errorNow(), 0.5);
  EXPECT_LT(distance(*shared.robots()[1].map_in_shared * second.keyframes().front().pose, frame),
            0.3);
  EXPECT_EQ(shared.state().state.keyframes.size(), all);
}

TEST(SharedMap, LosesNothingWhenARobotBeginsAnew) {
  const Robots& r = robots();
  SharedMap shared = r.merged;
  const std::size_t before = shared.state().state.keyframes.size();
  // Its SLAM was started again without what it knew.
  SlamEngine again;
  hyselam::RobotLog later = visit(5, 6, {-3.0, 1.0, -1.0});
  for (hyselam::LaserScan& scan : later.scans) scan.stamp += 1000.0;
  for (hyselam::StampedPose2& p : later.odometry) p.stamp += 1000.0;
  drive(later, 0.2, 0.6, &again);
  tell(again, "b2", 1, &shared);
  EXPECT_EQ(shared.state().state.keyframes.size(), before);
  EXPECT_FALSE(shared.robots()[1].map_in_shared);
  EXPECT_EQ(shared.robots()[1].keyframes, r.second.keyframes().size() + again.keyframes().size());
  merge(&shared);
  ASSERT_TRUE(shared.robots()[1].map_in_shared);
  EXPECT_EQ(shared.state().state.keyframes.size(), before + again.keyframes().size());
  EXPECT_EQ(shared.state().robot_of_run, (std::vector<std::size_t>{0, 1, 1}));
}

TEST(SharedMap, AMapThatGoesOnTakesThePlaceOfTheFormerOne) {
  const Robots& r = robots();
  SharedMap shared = r.merged;
  const std::size_t before = shared.state().state.keyframes.size();
  const Pose2 where = *shared.robots()[1].map_in_shared;
  // Its SLAM was started again with what it knew.
  SlamEngine again(SlamParams{}, r.second.state());
  tell(again, "b2", 1, &shared);
  EXPECT_EQ(shared.state().state.keyframes.size(), before);
  EXPECT_LT(distance(*shared.robots()[1].map_in_shared, where), 1e-9);
  EXPECT_EQ(shared.robots()[1].keyframes, r.second.keyframes().size());
  merge(&shared);
  EXPECT_TRUE(shared.robots()[1].map_in_shared);
}

TEST(SharedMap, GivesUpTheLeastFormerMaps) {
  SharedMapParams params;
  params.max_former_maps = 2;
  SharedMap shared({"a", "b"}, params);
  for (int i = 0; i < 5; ++i) {
    SlamEngine engine;
    drive(logs().first, 0.1 * i, 0.1 * i + (i == 2 ? 0.09 : 0.03), &engine);
    tell(engine, "m" + std::to_string(i), 0, &shared);
  }
  EXPECT_EQ(shared.formerMapsGivenUp(), 2);
  EXPECT_TRUE(shared.takeWork());
  params.max_former_maps = -1;
  EXPECT_THROW(SharedMap({"a", "b"}, params), hyselam::ParameterError);
}

TEST(SharedMap, IsOfOneRobotWhileTheOtherIsSilent) {
  SharedMap shared({"a", "b"});
  EXPECT_TRUE(shared.state().state.keyframes.empty());
  EXPECT_FALSE(shared.takeWork());
  SlamEngine engine;
  drive(logs().first, 0.0, 0.1, &engine);
  tell(engine, "a1", 0, &shared);
  EXPECT_EQ(shared.state().state.keyframes.size(), engine.keyframes().size());
  EXPECT_LT(errorOf(shared, 0, engine, logs().first), 0.3);
  drive(logs().first, 0.1, 0.2, &engine);
  tell(engine, "a1", 0, &shared);
  EXPECT_EQ(shared.state().state.keyframes.size(), engine.keyframes().size());
  EXPECT_FALSE(shared.takeWork());  // one map needs no merging
}

TEST(SharedMap, OfOneRobotIsAsItsSlamHasIt) {
  SharedMap shared({"a", "b"});
  SlamEngine engine;
  drive(logs().first, 0.0, 0.2, &engine);
  tell(engine, "a1", 0, &shared);
  const auto revision = engine.revision();
  drive(logs().first, 0.2, 1.0, &engine);
  ASSERT_GT(engine.revision(), revision);  // what was told at first lies elsewhere now
  tell(engine, "a1", 0, &shared);
  const SharedMapState state = shared.state();
  ASSERT_EQ(state.state.keyframes.size(), engine.keyframes().size());
  for (std::size_t k = 0; k < engine.keyframes().size(); ++k) {
    EXPECT_LT(distance(state.state.keyframes[k].pose, engine.keyframes()[k].pose), 1e-9) << k;
  }
  // So does one beside a robot in another building, after they were merged.
  const Robots& r = robots();
  SharedMap apart({"a", "c"});
  SlamEngine again;
  drive(logs().first, 0.0, 0.2, &again);
  tell(again, "a1", 0, &apart);
  tell(r.other, "c1", 1, &apart);
  merge(&apart);
  drive(logs().first, 0.2, 1.0, &again);
  tell(again, "a1", 0, &apart);
  const SharedMapState alone = apart.state();
  ASSERT_EQ(alone.state.keyframes.size(), again.keyframes().size());
  for (std::size_t k = 0; k < again.keyframes().size(); ++k) {
    EXPECT_LT(distance(alone.state.keyframes[k].pose, again.keyframes()[k].pose), 1e-9) << k;
  }
}

TEST(SharedMap, WhatWasSeenLastComesLast) {
  const Robots& r = robots();
  SharedMap shared = r.merged;
  SlamEngine again;  // begins anew, in the place of b, after all others
  hyselam::RobotLog later = visit(5, 6, {-3.0, 1.0, -1.0});
  for (hyselam::LaserScan& scan : later.scans) scan.stamp += 1000.0;
  for (hyselam::StampedPose2& p : later.odometry) p.stamp += 1000.0;
  drive(later, 0.2, 0.6, &again);
  tell(again, "a2", 0, &shared);
  merge(&shared);
  ASSERT_TRUE(shared.robots()[0].map_in_shared);
  const SharedMapState state = shared.state();
  double newest = 0.0;
  for (std::size_t k = 0; k < state.state.keyframes.size(); ++k) {
    const SlamKeyframe& here = state.state.keyframes[k];
    if (k + 1 < state.state.keyframes.size() && state.state.keyframes[k + 1].run == here.run) {
      continue;
    }
    EXPECT_GT(here.stamp, newest) << "run " << here.run << " ended earlier than the one before";
    newest = here.stamp;
  }
  EXPECT_EQ(state.robot_of_run.back(), 0U);
  EXPECT_EQ(state.state.error(), nullptr);
}

TEST(SharedMap, CountsNoTiesOfMapsThatAreGone) {
  SharedMapParams params;
  params.max_former_maps = 0;
  const Robots& r = robots();
  SharedMap shared({"a", "b"}, params);
  tell(r.first, "a1", 0, &shared);
  tell(r.second, "b1", 1, &shared);
  merge(&shared);
  ASSERT_GT(shared.robots()[0].ties, 0);
  SlamEngine again;
  drive(logs().other, 0.0, 0.1, &again);
  tell(again, "b2", 1, &shared);
  EXPECT_EQ(shared.formerMapsGivenUp(), 1);
  EXPECT_EQ(shared.robots()[0].ties, 0);
}

TEST(SharedMap, AMergingThatIsBrokenOffIsDoneAgain) {
  struct Enough {};
  SharedMap shared = robots().apart;
  auto work = shared.takeWork();
  ASSERT_TRUE(work);
  int told = 0;
  const auto stop = [&](const std::string&, std::size_t, std::size_t) {
    if (++told == 3) throw Enough{};
  };
  EXPECT_THROW(SharedMap::merge(&*work, shared.params().merging, stop), Enough);
  EXPECT_FALSE(shared.takeWork());
  shared.giveBack();
  merge(&shared);
  EXPECT_EQ(textOf(shared), "a and b are in one map; c is not recognized in it; c does not answer");
}

TEST(SharedMap, MarkersTellTheRobotsApart) {
  const Robots& r = robots();
  SharedMap shared = r.merged;
  const auto markers = sharedMapMarkers(shared.state(), {"a", "b", "c"}, {}).markers;
  std::map<std::string, int> count;
  for (const auto& m : markers) ++count[m.ns];
  EXPECT_EQ(count["path"], 2);
  EXPECT_EQ(count["robots"], 2);
  EXPECT_EQ(count["names"], 2);
  EXPECT_EQ(count["ties"], 1);
  EXPECT_EQ(static_cast<int>(markers.back().points.size()), 2 * shared.robots()[0].ties);
}

}  // namespace
}  // namespace ngram_slam

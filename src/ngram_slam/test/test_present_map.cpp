// The map of a building that changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_sim/laser.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "ngram_slam/slam/state_parts.hpp"

namespace ngram_slam {
namespace {

using hyselam::OccupancyGrid;
using hyselam::Point2;
using hyselam::Pose2;

using Segments = std::vector<hyselam_sim::Segment>;

/// The sides of a rectangle.
void addBox(double x0, double y0, double x1, double y1, Segments* segments) {
  const hyselam_sim::Point2 corners[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  for (int i = 0; i < 4; ++i) segments->push_back({corners[i], corners[(i + 1) % 4]});
}

/// A room of 6 x 4 m; boxes stand at the given points.
Segments room(const std::vector<hyselam_sim::Point2>& boxes) {
  Segments segments;
  addBox(0.0, 0.0, 6.0, 4.0, &segments);
  for (const auto& b : boxes) addBox(b.x - 0.2, b.y - 0.2, b.x + 0.2, b.y + 0.2, &segments);
  return segments;
}

/// A visit of the room, from both ends.
void visitRoom(const Segments& segments, std::uint32_t run, SlamState* state) {
  hyselam::Rng rng(run + 1);
  const hyselam_sim::PlanRayCaster world(segments);
  const hyselam_sim::LaserParams laser;
  int n = 0;
  for (const Pose2& from : {Pose2{0.6, 2.0, 0.0}, Pose2{5.4, 2.0, hyselam::kPi}}) {
    for (int i = 0; i < 12; ++i, ++n) {
      SlamKeyframe k;
      k.run = run;
      k.stamp = 100.0 * run + n;
      k.pose = from * Pose2{0.05 * i, 0.15 * std::sin(i), 0.02 * (i % 3)};
      k.odometry = k.pose;
      k.path_length = 10.0 * run + 0.2 * n;
      k.scan = std::make_shared<const hyselam::LaserScan>(
          takeScan(laser, world, {}, k.pose, k.stamp, rng));
      k.points = std::make_shared<const hyselam_scan_matching::SurfacePoints>(
          hyselam_scan_matching::surfacePoints(*k.scan));
      const int index = static_cast<int>(state->keyframes.size());
      state->keyframes.push_back(k);
      state->scans.push_back({k.stamp, index, {}});
      if (n > 0) {
        state->odometry.push_back(
            {index - 1, index,
             between(state->keyframes[static_cast<std::size_t>(index - 1)].pose, k.pose),
             100.0 * Eigen::Matrix3d::Identity()});
      } else if (run > 0) {
        SlamLoop tie;
        tie.older = 0;
        tie.newer = index;
        tie.measured = between(state->keyframes[0].pose, k.pose);
        tie.information = 100.0 * Eigen::Matrix3d::Identity();
        state->loops.push_back(tie);
      }
    }
  }
}

const std::vector<hyselam_sim::Point2> kBefore = {{2.0, 1.0}, {4.0, 3.0}};
const std::vector<hyselam_sim::Point2> kAfter = {{3.0, 1.0}, {4.0, 3.0}};

SlamState visits(const std::vector<std::vector<hyselam_sim::Point2>>& boxes) {
  SlamState state;
  for (std::size_t run = 0; run < boxes.size(); ++run) {
    visitRoom(room(boxes[run]), static_cast<std::uint32_t>(run), &state);
  }
  return state;
}

PresentMap mapOf(const SlamState& state, std::uint32_t session = 1000) {
  PresentMap map{hyselam::OccupancyMapperParams{}};
  const std::vector<bool> shown(state.keyframes.back().run + 1, true);
  map.update({state.keyframes, state.settled, shown, session, 0});
  return map;
}

/// Whether a box is seen around that point: its edges are.
bool hasBox(const OccupancyGrid& grid, double x, double y) {
  int occupied = 0;
  for (double dx = -0.28; dx <= 0.28; dx += 0.05) {
    for (double dy = -0.28; dy <= 0.28; dy += 0.05) {
      occupied += grid.valueOr(grid.geometry.cellAt({x + dx, y + dy})) == OccupancyGrid::kOccupied;
    }
  }
  return occupied > 5;
}

TEST(PresentMap, isThatOfTheOccupancyMapperForOneRun) {
  const SlamState state = visits({kBefore});
  hyselam::OccupancyMapper mapper;
  for (const SlamKeyframe& k : state.keyframes) mapper.insert(k.pose, *k.scan);
  const OccupancyGrid expected = mapper.grid(), grid = mapOf(state).grid();
  EXPECT_EQ(grid.geometry.width, expected.geometry.width);
  EXPECT_NEAR(grid.geometry.origin.x, expected.geometry.origin.x, 1e-9);
  EXPECT_EQ(grid.cells, expected.cells);
}

TEST(PresentMap, forgetsWhatHasGoneAndKnowsWhatHasCome) {
  const OccupancyGrid grid = mapOf(visits({kBefore, kAfter})).grid();
  EXPECT_FALSE(hasBox(grid, 2.0, 1.0));
  EXPECT_TRUE(hasBox(grid, 3.0, 1.0));
  EXPECT_TRUE(hasBox(grid, 4.0, 3.0));
  EXPECT_TRUE(hasBox(grid, 0.0, 1.0));  // the wall
}

TEST(PresentMap, tellsWhatChangedSinceTheSession) {
  const SlamState state = visits({kBefore, kAfter});
  const auto changes = mapOf(state, 1).changes();
  ASSERT_FALSE(changes.empty());
  bool gone = false, appeared = false;
  for (const MapChange& c : changes) {
    const double old_place = std::hypot(c.center.x - 2.0, c.center.y - 1.0);
    const double new_place = std::hypot(c.center.x - 3.0, c.center.y - 1.0);
    gone = gone || (c.kind == MapChange::Kind::kGone && old_place < 0.3);
    appeared = appeared || (c.kind == MapChange::Kind::kAppeared && new_place < 0.3);
    EXPECT_LT(std::min(old_place, new_place), 0.5) << c.center.x << ' ' << c.center.y;
    EXPECT_GT(c.probability, 0.5);
    EXPECT_FALSE(c.again);
  }
  EXPECT_TRUE(gone);
  EXPECT_TRUE(appeared);
  EXPECT_TRUE(mapOf(state, 2).changes().empty());  // nothing was seen since
  EXPECT_EQ(summaryOf({}), "nothing changed");
  EXPECT_EQ(summaryOf({}, false), "not known: the session is not tied to the map");
  EXPECT_TRUE(mapOf(visits({kBefore, kBefore}), 1).changes().empty());
}

TEST(PresentMap, hasTwoStatesOfWhatComesAndGoes) {
  const auto changes = mapOf(visits({kBefore, kAfter, kBefore, kAfter}), 3).changes();
  ASSERT_FALSE(changes.empty());
  EXPECT_TRUE(changes.front().again);
  EXPECT_NE(summaryOf(changes).find("not for the first time"), std::string::npos);
}

TEST(PresentMap, isMoreSureOfWhatWasSeenOften) {
  const auto atWall = [](const SlamState& state) {
    const OccupancyGrid p = mapOf(state).probabilities();
    int most = 0;
    for (double dx = -0.15; dx <= 0.15; dx += 0.05) {
      most = std::max<int>(most, p.valueOr(p.geometry.cellAt({dx, 1.0})));
    }
    return most;
  };
  EXPECT_GE(atWall(visits({kBefore, kBefore, kBefore})), atWall(visits({kBefore})));
}

TEST(PresentMap, isTheSameWhenKeyframesThatAddNothingAreDropped) {
  const SlamState all = visits({kBefore, kBefore, kAfter, kAfter});
  const SlamState few = consolidated(all);
  ASSERT_LT(few.keyframes.size(), all.keyframes.size());
  EXPECT_FALSE(few.settled.cells.empty());
  const OccupancyGrid a = mapOf(all).grid(), b = mapOf(few).grid();
  std::size_t differ = 0, compared = 0;
  for (int y = 0; y < a.geometry.height; ++y) {
    for (int x = 0; x < a.geometry.width; ++x) {
      if (a.at({x, y}) == OccupancyGrid::kUnknown) continue;
      ++compared;
      differ += a.at({x, y}) != b.valueOr(b.geometry.cellAt(a.geometry.center({x, y})));
    }
  }
  EXPECT_LT(differ, compared / 1000) << compared;
  EXPECT_FALSE(hasBox(b, 2.0, 1.0));
  EXPECT_TRUE(hasBox(b, 3.0, 1.0));
}

TEST(PresentMap, whatWasSettledIsUnderWhatWasSeenSince) {
  // Two robots go on with maps of which keyframes were dropped, as other things stand there now.
  SlamState first = consolidated(visits({kBefore, kBefore, kBefore}));
  ASSERT_FALSE(first.settled.cells.empty());
  visitRoom(room(kAfter), 3, &first);
  const SlamState second = first;
  const SlamState both = joinedStates({second, first});
  const std::vector<bool> all(runsOf(both), true);
  for (const SlamState& state : {joinedStates({first}), both, partOfState(both, all)}) {
    ASSERT_EQ(state.error(), nullptr);
    const OccupancyGrid grid = mapOf(state).grid();
    EXPECT_FALSE(hasBox(grid, 2.0, 1.0));
    EXPECT_TRUE(hasBox(grid, 3.0, 1.0));
  }
}

TEST(PresentMap, joinsWhatWasSettledInLargeAndInSmallCells) {
  ConsolidationParams coarse;
  coarse.settled_cell = 0.1;
  const SlamState large = consolidated(visits({kBefore, kAfter, kAfter, kAfter}), coarse);
  const SlamState small = consolidated(visits({kBefore, kAfter, kAfter, kAfter}));
  ASSERT_FALSE(large.settled.cells.empty());
  const auto area = [](const SlamState& s) {
    return s.settled.cell * s.settled.cell * static_cast<double>(s.settled.cells.size());
  };
  for (const auto& states : {std::vector<SlamState>{large, small}, {small, large}}) {
    const SlamState joined = joinedStates(states);
    EXPECT_EQ(joined.settled.cell, 0.05);
    EXPECT_NEAR(area(joined), area(large) + area(small), 1e-9);
  }
  // A large cell is where it was.
  const SlamState joined = joinedStates({large, small});
  Point2 middle{};
  for (std::size_t i = 0; i < 4; ++i) {
    middle.x += 0.25 * joined.settled.cells[i].center.x;
    middle.y += 0.25 * joined.settled.cells[i].center.y;
  }
  EXPECT_NEAR(middle.x, large.settled.cells[0].center.x, 1e-9);
  EXPECT_NEAR(middle.y, large.settled.cells[0].center.y, 1e-9);
}

TEST(PresentMap, settlesWhatTheMapShows) {
  // What is beyond the range that the map uses is not settled: it is not shown either.
  ConsolidationParams strict;
  strict.map.usable_range = 1.0;
  const SlamState state = visits({kBefore, kAfter, kAfter, kAfter});
  const SlamState few = consolidated(state, strict);
  ASSERT_LT(few.keyframes.size(), state.keyframes.size());
  for (const SettledCell& c : few.settled.cells) {
    const Point2 center = few.keyframes[static_cast<std::size_t>(c.keyframe)].pose * c.center;
    double nearest = 1e9;
    for (const SlamKeyframe& k : state.keyframes) {
      nearest = std::min(nearest, std::hypot(center.x - k.pose.x, center.y - k.pose.y));
    }
    EXPECT_LT(nearest, 1.3);
  }
}

/// Saved as version 3 was: one run for all settled cells.
SlamState readAsVersion3(const hyselam::testing::TemporaryDirectory& d, const SlamState& state) {
  SlamStateFile::save(d / "new.state", state);
  std::string bytes = hyselam::testing::fileBytes(d / "new.state");
  const auto textOf = [](const auto& value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  const auto n = static_cast<std::uint32_t>(state.settled.cells.size());
  const auto begin = bytes.rfind(textOf(state.settled.cell) + textOf(n));
  constexpr std::size_t kCell = 28, kRun = 4;
  for (std::size_t i = 0; i < n; ++i) bytes.erase(begin + 12 + (i + 1) * kCell, kRun);
  bytes.insert(begin, textOf(state.settled.cells.front().run));
  bytes.replace(8, 4, textOf(std::uint32_t{3}));
  bytes.replace(12, 8, textOf(static_cast<std::uint64_t>(bytes.size() - 28)));
  bytes.replace(20, 4, textOf(hyselam::checksumOf(bytes, 0, 20)));
  bytes.replace(bytes.size() - 4, 4, textOf(hyselam::checksumOf(bytes, 24, bytes.size() - 4)));
  hyselam::testing::writeFile(d / "old.state", bytes);
  return SlamStateFile::load(d / "old.state", {});
}

TEST(PresentMap, isSavedWithTheState) {
  const hyselam::testing::TemporaryDirectory d;
  const SlamState few = consolidated(visits({kBefore, kAfter, kAfter, kAfter}));
  SlamStateFile::save(d / "a.state", few);
  const SlamState loaded = SlamStateFile::load(d / "a.state", {});
  ASSERT_EQ(loaded.settled.cells.size(), few.settled.cells.size());
  for (std::size_t i = 0; i < few.settled.cells.size(); ++i) {
    EXPECT_EQ(few.settled.cells[i].run, 3U);
    EXPECT_EQ(loaded.settled.cells[i].run, 3U);
  }
  EXPECT_EQ(mapOf(loaded).grid().cells, mapOf(few).grid().cells);
  EXPECT_EQ(readAsVersion3(d, few).settled.cells.back().run, 3U);
  SlamState bad = few;
  bad.settled.cells.at(0).keyframe = 100000;
  EXPECT_NE(bad.error(), nullptr);
  bad = few;
  bad.settled.cell = 0.0;
  EXPECT_NE(bad.error(), nullptr);
}

}  // namespace
}  // namespace ngram_slam

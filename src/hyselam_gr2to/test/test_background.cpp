#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/background_gr2to.hpp"

namespace hyselam_topo {
namespace {

using hyselam::OccupancyGrid;

OccupancyGrid gridOf(int width) {
  hyselam::GridGeometry geometry;
  geometry.width = width;
  geometry.height = 2;
  geometry.resolution = 1.0;
  return OccupancyGrid(geometry, OccupancyGrid::kFree);
}

/// One place that fills the grid.
Gr2ToResult onePlace(const OccupancyGrid& grid) {
  Gr2ToResult result;
  Place place;
  place.id = 1;
  place.area = static_cast<double>(grid.cells.size());
  result.map.places = {place};
  PlaceGrid labels;
  labels.geometry = grid.geometry;
  labels.labels.assign(grid.cells.size(), 1);
  labels.places = {1};
  result.map.grid = labels;
  result.map.next_place_id = 2;
  return result;
}

/// A pipeline that waits until it may go on, and counts.
class Gate {
 public:
  BackgroundGr2To::Pipeline pipeline() {
    return [this](const OccupancyGrid& grid, const Gr2ToParams&) {
      std::unique_lock<std::mutex> lock(mutex_);
      ++entered_;
      changed_.notify_all();
      changed_.wait(lock, [&] { return passes_ > 0; });
      --passes_;
      widths_.push_back(grid.geometry.width);
      return onePlace(grid);
    };
  }
  void waitForEntry(int count) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return entered_ >= count; });
  }
  void open(int passes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    passes_ += passes;
    changed_.notify_all();
  }
  std::vector<int> widths() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return widths_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int entered_ = 0, passes_ = 0;
  std::vector<int> widths_;
};

class Outcomes {
 public:
  std::function<void(const BackgroundGr2To::Outcome&)> sink() {
    return [this](const BackgroundGr2To::Outcome& outcome) {
      const std::lock_guard<std::mutex> lock(mutex_);
      list_.push_back(outcome);
      changed_.notify_all();
    };
  }
  BackgroundGr2To::Outcome wait(std::size_t number) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return list_.size() >= number; });
    return list_[number - 1];
  }
  std::size_t count() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return list_.size();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<BackgroundGr2To::Outcome> list_;
};

BackgroundGr2To::Input input(int width, int params_version = 0) {
  BackgroundGr2To::Input in;
  in.grid = [width] { return gridOf(width); };
  in.stamp = width;
  in.params_version = params_version;
  return in;
}

TEST(Background, NewestMapWins) {
  Gate gate;
  Outcomes outcomes;
  BackgroundGr2To background(outcomes.sink(), gate.pipeline());
  EXPECT_EQ(background.current(), nullptr);
  background.start(input(3));
  gate.waitForEntry(1);
  // While the first is in work, others come: of those only the last is used.
  for (const int width : {4, 5, 6}) background.start(input(width));
  EXPECT_TRUE(background.busy());
  gate.open(2);
  EXPECT_EQ(outcomes.wait(2).map->stamp, 6.0);
  EXPECT_EQ(gate.widths(), (std::vector<int>{3, 6}));
  EXPECT_EQ(background.current(), outcomes.wait(2).map);
}

TEST(Background, SameGridIsNotSegmentedAgain) {
  Gate gate;
  Outcomes outcomes;
  BackgroundGr2To background(outcomes.sink(), gate.pipeline());
  gate.open(10);
  background.start(input(3));
  EXPECT_FALSE(outcomes.wait(1).unchanged);
  background.start(input(3));
  EXPECT_TRUE(outcomes.wait(2).unchanged);
  EXPECT_EQ(outcomes.wait(2).map, outcomes.wait(1).map);
  background.start(input(3, 1));  // other parameters
  EXPECT_FALSE(outcomes.wait(3).unchanged);
  auto elsewhere = input(3, 1);
  elsewhere.frame_id = "odom";
  background.start(elsewhere);
  EXPECT_FALSE(outcomes.wait(4).unchanged);
  EXPECT_NE(outcomes.wait(4).warning, "");
  EXPECT_EQ(gate.widths().size(), 3u);
}

TEST(Background, NamesOfALoadedMapAreCarriedOver) {
  Gate gate;
  Outcomes outcomes;
  BackgroundGr2To background(outcomes.sink(), gate.pipeline());
  AugmentedTopologicalMap known = onePlace(gridOf(3)).map;
  known.places[0].id = 7;
  known.grid->places = {7};
  known.next_place_id = 8;
  known.places[0].words = {{"hall", true}};
  background.replace(known, "file");
  gate.open(10);
  background.start(input(4));
  const auto outcome = outcomes.wait(1);
  EXPECT_EQ(outcome.map->places.at(0).id, 7u);
  EXPECT_EQ(outcome.map->places.at(0).words.at(0).text, "hall");
  EXPECT_EQ(outcome.report.kept, (std::vector<Id>{7}));
}

TEST(Background, MapLoadedDuringASegmentationIsCarriedOver) {
  Gate gate;
  Outcomes outcomes;
  BackgroundGr2To background(outcomes.sink(), gate.pipeline());
  background.start(input(3));
  gate.waitForEntry(1);
  AugmentedTopologicalMap known = onePlace(gridOf(3)).map;
  known.places[0].words = {{"hall", true}};
  background.replace(known, "file");
  gate.open(1);
  EXPECT_EQ(outcomes.wait(1).map->places.at(0).words.size(), 1u);
  EXPECT_THROW(background.replace(AugmentedTopologicalMap{}, "file"), hyselam::InputError);
}

TEST(Background, BadInputLeavesTheMapAsItWas) {
  Outcomes outcomes;
  BackgroundGr2To background(outcomes.sink(), [](const OccupancyGrid& grid, const Gr2ToParams&) {
    if (grid.geometry.width == 5) throw std::bad_alloc();
    return onePlace(grid);
  });
  background.start(input(3));
  const auto good = outcomes.wait(1).map;
  BackgroundGr2To::Input bad;
  bad.grid = []() -> OccupancyGrid { throw hyselam::InputError("map", "", "it is bad"); };
  background.start(bad);
  EXPECT_EQ(outcomes.wait(2).error, "map: it is bad");
  EXPECT_EQ(outcomes.wait(2).map, nullptr);
  background.start(input(5));
  EXPECT_EQ(outcomes.wait(3).error, "not enough memory for this map");
  EXPECT_EQ(background.current(), good);
  background.start(input(4));
  EXPECT_EQ(outcomes.wait(4).error, "");
}

/// Two rooms of 4 m x 4 m with a door of 1 m, and a box at `x` of this size in the left one [m].
OccupancyGrid rooms(double x, double size) {
  hyselam::GridGeometry geometry;
  geometry.width = 170;
  geometry.height = 84;
  geometry.resolution = 0.05;
  OccupancyGrid grid(geometry, OccupancyGrid::kFree);
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column) {
      const auto c = geometry.center({column, row});
      const bool limit = c.x < 0.1 || c.x > 8.4 || c.y < 0.1 || c.y > 4.1;
      const bool wall = c.x > 4.1 && c.x < 4.25 && (c.y < 1.5 || c.y > 2.5);
      const bool box = c.x > x && c.x < x + size && c.y > 3.0 && c.y < 3.0 + size;
      if (limit || wall || box) grid.at({column, row}) = OccupancyGrid::kOccupied;
    }
  }
  return grid;
}

TEST(Background, PartialUpdatesAreAsGoodAsFromScratch) {
  for (const int max_partial_updates : {0, 2, 50}) {
    const auto pipeline = BackgroundGr2To::updating(max_partial_updates);
    for (int i = 0; i < 6; ++i) {
      const Gr2ToResult result = pipeline(rooms(1.0 + 0.2 * i, 0.3), {});
      ASSERT_EQ(result.map.places.size(), 2u) << max_partial_updates << " " << i;
      ASSERT_EQ(result.map.edges.size(), 1u);
      EXPECT_EQ(result.map.edges[0].doors.size(), 1u);
    }
  }
}

}  // namespace
}  // namespace hyselam_topo

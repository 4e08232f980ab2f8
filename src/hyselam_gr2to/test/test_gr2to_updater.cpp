// A map that is updated bit by bit against one from scratch.
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <opencv2/imgproc.hpp>

#include "agreement.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_gr2to/gr2to_updater.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::OccupancyGrid;

namespace {

OccupancyGrid floorOf(std::uint64_t seed) {
  return hyselam_sim::rasterize(hyselam_sim::generatePlan(seed), 0.05, 0.0);
}

void fill(OccupancyGrid* grid, const cv::Rect& box, std::int8_t value) {
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (grid->geometry.contains({x, y})) grid->at({x, y}) = value;
    }
  }
}

// What every result must be.
void expectSound(const OccupancyGrid& grid, const Gr2ToResult& r) {
  EXPECT_NO_THROW(checkMap(r.map, "test"));
  const int places = static_cast<int>(r.map.places.size());
  double highest = 0.0;
  cv::minMaxLoc(r.labels, nullptr, &highest);
  ASSERT_EQ(places, static_cast<int>(highest));
  for (int label = 1; label <= places; ++label) {
    const cv::Mat mask = r.labels == label;
    cv::Mat parts;
    EXPECT_EQ(2, cv::connectedComponents(mask, parts, 4)) << "label " << label;
    const Place& place = r.map.places[static_cast<std::size_t>(label - 1)];
    EXPECT_EQ(static_cast<Id>(label), place.id);
    EXPECT_NEAR(cv::countNonZero(mask) * 0.0025, place.area, 1e-6) << "label " << label;
    ASSERT_TRUE(place.centre.has_value());
    EXPECT_EQ(place.id,
              r.map.grid->placeOf(grid.geometry.cellAt({place.centre->x, place.centre->y})));
    EXPECT_FALSE(place.walls.empty());
  }
  for (const DoorLine& d : r.doors) {
    EXPECT_LT(d.place_a, d.place_b);
    EXPECT_GE(d.place_a, 1);
    EXPECT_LE(d.place_b, places);
  }
  // All of a place is floor, or what stands on it.
  for (int y = 0; y < r.labels.rows; ++y) {
    for (int x = 0; x < r.labels.cols; ++x) {
      if (r.labels.at<std::uint16_t>(y, x) == 0) continue;
      ASSERT_NE(OccupancyGrid::kUnknown, grid.at({x, y}));
    }
  }
}

}  // namespace

TEST(Gr2ToUpdater, FirstGridIsFromScratchTheSameIsUnchanged) {
  const OccupancyGrid grid = floorOf(3);
  Gr2ToUpdater updater;
  const Gr2ToResult& r = updater.update(grid);
  EXPECT_EQ(Gr2ToUpdater::UpdateKind::kFromScratch, updater.lastUpdate());
  const Gr2ToResult fresh = gr2to(grid);
  EXPECT_EQ(0, cv::countNonZero(fresh.labels != r.labels));
  EXPECT_TRUE(fresh.map == r.map);
  OccupancyGrid nearly = grid;
  for (auto& v : nearly.cells) {
    if (v == 0) v = 7;  // still free
  }
  EXPECT_TRUE(fresh.map == updater.update(nearly).map);
  EXPECT_EQ(Gr2ToUpdater::UpdateKind::kUnchanged, updater.lastUpdate());
  Gr2ToParams other;
  other.segmentation.min_place_area = 2.0;
  updater.update(grid, other);
  EXPECT_EQ(Gr2ToUpdater::UpdateKind::kFromScratch, updater.lastUpdate());
}

TEST(Gr2ToUpdater, TableChangesItsPlaceOnly) {
  const OccupancyGrid grid = floorOf(6);
  Gr2ToUpdater updater;
  const Gr2ToResult before = updater.update(grid);
  // In the middle of place 3.
  const Point3 at = *before.map.places[2].centre;
  const hyselam::Cell c = grid.geometry.cellAt({at.x, at.y});
  OccupancyGrid with = grid;
  fill(&with, {c.x - 8, c.y - 6, 16, 12}, OccupancyGrid::kOccupied);
  const Gr2ToResult& after = updater.update(with);
  EXPECT_EQ(Gr2ToUpdater::UpdateKind::kPartial, updater.lastUpdate());
  expectSound(with, after);
  ASSERT_EQ(before.map.places.size(), after.map.places.size());
  cv::Mat rest = before.labels.clone(), rest_after = after.labels.clone();
  rest.setTo(0, before.labels == 3);
  rest_after.setTo(0, before.labels == 3);
  EXPECT_EQ(0, cv::countNonZero(rest != rest_after));
  updater.update(grid);
  EXPECT_EQ(Gr2ToUpdater::UpdateKind::kPartial, updater.lastUpdate());
}

TEST(Gr2ToUpdater, RandomEditsGiveValidMapsCloseToThoseFromScratch) {
  int partial = 0, all = 0;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    hyselam::Rng rng(seed, 77);
    const auto upTo = [&](int n) {
      return static_cast<int>(rng.below(static_cast<std::uint32_t>(n)));
    };
    const OccupancyGrid plan = floorOf(seed);
    OccupancyGrid grid = plan;
    Gr2ToUpdater updater;
    updater.update(grid);
    for (int step = 0; step < 12; ++step) {
      const cv::Rect box(upTo(plan.geometry.width), upTo(plan.geometry.height), 2 + upTo(20),
                         2 + upTo(20));
      if (rng.uniform() < 0.6) {
        // Something is put there (not onto walls), or the plan's own state comes back.
        for (int y = box.y; y < box.y + box.height; ++y) {
          for (int x = box.x; x < box.x + box.width; ++x) {
            if (grid.valueOr({x, y}) == 0) grid.at({x, y}) = OccupancyGrid::kOccupied;
          }
        }
      } else {
        const cv::Rect wide(box.x - 20, box.y - 20, 60, 60);
        for (int y = wide.y; y < wide.y + wide.height; ++y) {
          for (int x = wide.x; x < wide.x + wide.width; ++x) {
            if (grid.geometry.contains({x, y})) grid.at({x, y}) = plan.at({x, y});
          }
        }
      }
      const Gr2ToResult& r = updater.update(grid);
      if (updater.lastUpdate() == Gr2ToUpdater::UpdateKind::kUnchanged) continue;
      ++all;
      partial += updater.lastUpdate() == Gr2ToUpdater::UpdateKind::kPartial ? 1 : 0;
      expectSound(grid, r);
      if (HasFatalFailure() || HasNonfatalFailure()) FAIL() << "seed " << seed << ", " << step;
      sum += agreement(r.labels, gr2to(grid).labels);
    }
  }
  EXPECT_GE(partial, all / 2) << "of " << all;
  EXPECT_GE(sum / all, 0.97);
  RecordProperty("partial", partial);
  std::cout << partial << " of " << all << " in part, agreement " << sum / all << "\n";
}

TEST(Gr2ToUpdater, WallAcrossACorridorSplitsIt) {
  // A corridor of 20 x 2 m without rooms.
  hyselam::GridGeometry g;
  g.width = 408;
  g.height = 200;
  g.resolution = 0.05;
  OccupancyGrid grid(g, OccupancyGrid::kUnknown);
  fill(&grid, {2, 60, 404, 44}, OccupancyGrid::kOccupied);
  fill(&grid, {4, 62, 400, 40}, OccupancyGrid::kFree);
  Gr2ToUpdater updater;
  const std::size_t before = updater.update(grid).map.places.size();
  fill(&grid, {200, 62, 2, 40}, OccupancyGrid::kOccupied);
  const Gr2ToResult& r = updater.update(grid);
  expectSound(grid, r);
  EXPECT_GT(r.map.places.size(), before);
}

TEST(Gr2ToUpdater, FailedUpdateIsFollowedByOneFromScratch) {
  const OccupancyGrid grid = floorOf(3);
  Gr2ToUpdater updater;
  updater.update(grid);
  OccupancyGrid broken = grid;
  broken.cells.pop_back();
  EXPECT_THROW(updater.update(broken), hyselam::InputError);
  expectSound(grid, updater.update(grid));
  UpdateParams params;
  params.context = 0.0;
  EXPECT_THROW(Gr2ToUpdater{params}, hyselam::ParameterError);
  params = UpdateParams();
  params.max_share = 2.0;
  EXPECT_THROW(Gr2ToUpdater{params}, hyselam::ParameterError);
}

// The search of whole maps: equal to an exhaustive transcription, right in rooms, and judged by
// comparison.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "drawn_room.hpp"
#include "driven_robot.hpp"
#include "fsd_localization/localizer.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::Point2;
using hyselam::Pose2;

namespace {

Submap submapOf(const std::vector<hyselam::LaserScan>& scans, const std::vector<Pose2>& poses) {
  SubmapBuilder builder;
  for (std::size_t i = 0; i < scans.size(); ++i) builder.add(scans[i], poses[i]);
  return builder.build();
}

/// ScoreLattice::search as its header says it, without any haste.
double exhaustiveBest(const hyselam::OccupancyGrid& map, const Submap& submap) {
  const auto& g = map.geometry;
  const double r = ScoreLattice::kCell;
  const int width = static_cast<int>(std::ceil(g.width * g.resolution / r - 1e-9));
  const int height = static_cast<int>(std::ceil(g.height * g.resolution / r - 1e-9));
  std::vector<int> score(static_cast<std::size_t>(width * height));
  std::vector<bool> free(score.size());
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      double nearest = std::numeric_limits<double>::infinity();
      for (int oy = 0; oy < g.height; ++oy) {
        for (int ox = 0; ox < g.width; ++ox) {
          if (map.at({ox, oy}) == 100) {
            nearest = std::min(nearest, std::hypot(ox - x, oy - y) * g.resolution);
          }
        }
      }
      const double d = std::round(100.0 * nearest) / 100.0;  // kept in centimetres
      const int s =
          nearest < 2.55 ? static_cast<int>(std::lround(255.0 * std::exp(-d * d / 2.0 / 0.09))) : 0;
      const auto i =
          static_cast<std::size_t>(static_cast<int>((y + 0.5) * g.resolution / r) * width +
                                   static_cast<int>((x + 0.5) * g.resolution / r));
      score[i] = std::max(score[i], s);
      free[i] = free[i] || map.at({x, y}) == 0;
    }
  }
  std::vector<Point2> points;
  const std::size_t n = std::min(PlaceSearch::kPoints, submap.points.size());
  for (std::size_t k = 0; k < n; ++k) points.push_back(submap.points[k * submap.points.size() / n]);
  int best = 0;
  for (int h = 0; h < ScoreLattice::kHeadings; ++h) {
    const double a = 2.0 * hyselam::kPi * h / ScoreLattice::kHeadings;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!free[static_cast<std::size_t>(y * width + x)]) continue;
        int sum = 0;
        for (const Point2& p : points) {
          const int px =
              x + static_cast<int>(std::floor((std::cos(a) * p.x - std::sin(a) * p.y) / r + 0.5));
          const int py =
              y + static_cast<int>(std::floor((std::sin(a) * p.x + std::cos(a) * p.y) / r + 0.5));
          if (px < 0 || py < 0 || px >= width || py >= height) continue;
          sum += score[static_cast<std::size_t>(py * width + px)];
        }
        best = std::max(best, sum);
      }
    }
  }
  return best / (255.0 * static_cast<double>(points.size()));
}

}  // namespace

TEST(Oracle, searchFindsWhatExhaustiveSearchFinds) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int compared = 0;
  for (int world = 0; world < 25; ++world) {
    const auto map = gridOf(random_worlds::rooms(rng, 60, 50));
    const GridRayCaster rays(map);
    const PlaceSearch search(map);
    const Pose2 at{1.0 + 4.0 * unit(rng), 1.0 + 3.0 * unit(rng), 6.28 * unit(rng)};
    Submap submap = submapOf({look(rays, at, 1.0)}, {{}});
    for (Point2& p : submap.points) p = {p.x + 0.1 * unit(rng), p.y + 0.1 * unit(rng)};
    const std::vector<Place> found = search.latticeSearch(submap, 3);
    const double best = submap.points.empty() ? 0.0 : exhaustiveBest(map, submap);
    if (best < 0.31) continue;  // nothing is told that fits no better
    ASSERT_FALSE(found.empty()) << "world " << world;
    ASSERT_NEAR(found.front().coarse, best, 1e-9) << "world " << world;
    for (std::size_t k = 1; k < found.size(); ++k) {
      EXPECT_GE(found[k - 1].coarse, found[k].coarse);
    }
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

TEST(PlaceSearch, findsTheRobotFromOneScan) {
  const auto map = room();
  const GridRayCaster rays(map);
  const PlaceSearch search(map);
  for (const Pose2& at : {Pose2{2.0, 2.0, 0.3}, Pose2{9.0, 6.0, -2.0}, Pose2{5.5, 1.2, 1.6}}) {
    const std::vector<Place> places = search.search(submapOf({look(rays, at, 1.0)}, {{}}));
    ASSERT_FALSE(places.empty());
    EXPECT_LT(distance(places[0].base, at), 0.15);  // the diagonal of a cell
    EXPECT_LT(std::abs(hyselam::normalizeAngle(places[0].base.theta - at.theta)), 0.03);
    for (std::size_t k = 1; k < places.size(); ++k) {
      EXPECT_LE(places[k].seen, places[k - 1].seen);
      EXPECT_FALSE(isSamePlace(places[k].base, places[0].base)) << "each place is told once";
    }
  }
}

TEST(PlaceSearch, wallsInTheWayTellAgainstAPlace) {
  const auto map = room();
  const PlaceSearch search(map);
  const Pose2 at{2.0, 2.0, 0.0};
  Submap submap = submapOf({look(GridRayCaster(map), at, 1.0)}, {{}});
  const Place clear = search.refine(submap, at);
  EXPECT_GT(clear.seen, 0.8);
  for (Submap::View& v : submap.views) v.laser = {5.0, 0.0};  // the ends are the same, seen from
  const Place blocked = search.refine(submap, at);            // behind a wall
  EXPECT_NEAR(blocked.ends, clear.ends, 1e-9);
  EXPECT_LT(blocked.seen, clear.seen - 0.2);
}

TEST(Submap, keepsTheLastMetresOnly) {
  const GridRayCaster rays(room());
  SubmapBuilder builder;
  EXPECT_TRUE(builder.build().points.empty());
  for (int i = 0; i <= 300; ++i) {
    const double x = 1.5 + 0.01 * (i % 300);
    builder.add(look(rays, {x, 2.0, 0.0}, i), {0.05 * i, 0.0, 0.0});
  }
  EXPECT_NEAR(builder.build().length, SubmapBuilder::kMaxLength, 0.4);
  const Submap last = builder.build(2.0);
  EXPECT_LE(last.length, 2.0);
  EXPECT_GT(last.length, 1.6);
  EXPECT_LE(last.views.size(), 12U);
  EXPECT_LT(last.points.size(), builder.build().points.size());
  builder.reset();
  EXPECT_TRUE(builder.empty());
}

TEST(Submap, forgetsWhatIsAskedTo) {
  const GridRayCaster rays(room());
  SubmapBuilder builder;
  builder.keepLast(0.0, 0.5);
  EXPECT_TRUE(builder.empty());
  for (int i = 0; i < 100; ++i) {
    builder.add(look(rays, {1.5 + 0.05 * i, 2.0, 0.0}, i), {0.05 * i, 0.0, 0.0});
  }
  builder.keepLast(2.0, 0.5);
  EXPECT_LE(builder.build().length, 2.0);
  EXPECT_GT(builder.build().length, 1.6);
  builder.keepLast(0.0, 0.5);
  EXPECT_EQ(builder.build().length, 0.0) << "the newest scan stays";
  EXPECT_FALSE(builder.build().points.empty());
  builder.add(look(rays, {6.5, 2.0, 0.0}, 100), {5.0, 0.0, 0.0});
  EXPECT_NEAR(builder.build().length, 0.05, 1e-9) << "and the next one joins it";
}

TEST(BackgroundSearch, answersCountByStamps) {
  const auto map = room();
  const Pose2 at{2.0, 2.0, 0.3};
  const Submap submap = submapOf({look(GridRayCaster(map), at, 1.0)}, {{}});
  const auto places = std::make_shared<const PlaceSearch>(map);
  BackgroundSearch search(places, 0.5);
  EXPECT_FALSE(search.take(100.0, true));
  search.ask(10.0, {1, 2, 3}, submap, at);
  EXPECT_FALSE(search.isDue(10.4));
  EXPECT_FALSE(search.take(10.4, true)) << "not before the latency";
  EXPECT_TRUE(search.isDue(10.5));
  const auto answer = search.take(10.5, true);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->stamp, 10.0);
  EXPECT_EQ(answer->base_in_odom.theta, 3.0);
  const std::vector<Place> direct = places->search(submap, at);
  ASSERT_EQ(answer->places.size(), direct.size());
  for (std::size_t k = 0; k < direct.size(); ++k) {
    EXPECT_EQ(answer->places[k].base.x, direct[k].base.x);
    EXPECT_EQ(answer->places[k].seen, direct[k].seen);
  }
  search.ask(11.0, {}, submap, {});
  EXPECT_FALSE(search.isLate(11.4)) << "nobody needs it yet";
  search.drop();
  EXPECT_FALSE(search.isDue(20.0));
  EXPECT_FALSE(search.take(20.0, true));
  EXPECT_FALSE(search.busy());
  search.ask(21.0, {}, submap, {});  // at once, whatever the dropped one is doing
  const auto next = search.take(21.5, true);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->stamp, 21.0);
  EXPECT_EQ(next->places.size(), places->search(submap).size()) << "nothing was believed";
  EXPECT_FALSE(search.isLate(30.0)) << "taken";
}

TEST(BackgroundSearch, whoAsksIsLateNeedsNotWait) {
  const auto map = room();
  const Submap submap = submapOf({look(GridRayCaster(map), {2.0, 2.0, 0.3}, 1.0)}, {{}});
  BackgroundSearch search(std::make_shared<const PlaceSearch>(map), 0.5);
  search.ask(10.0, {}, submap, {});
  while (search.isLate(10.5)) std::this_thread::yield();
  EXPECT_TRUE(search.take(10.5, false));
}

TEST(PlaceSearch, whatIsMuchWorseThanTheBelievedPlaceIsLeftOut) {
  const auto map = room();
  const PlaceSearch search(map);
  const Pose2 at{2.0, 2.0, 0.3};
  const Submap submap = submapOf({look(GridRayCaster(map), at, 1.0)}, {{}});
  const std::vector<Place> all = search.latticeSearch(submap, 1000);
  const std::vector<Place> rivals = search.latticeSearch(submap, 1000, at);
  const double least = all.front().coarse - 0.1;
  const auto better = std::count_if(all.begin(), all.end(),
                                    [&](const Place& p) { return p.coarse >= least + 1e-4; });
  EXPECT_LT(rivals.size(), all.size());
  ASSERT_GE(rivals.size(), static_cast<std::size_t>(better)) << "none that is as good is lost";
  for (std::size_t k = 0; k < static_cast<std::size_t>(better); ++k) {
    EXPECT_EQ(rivals[k].coarse, all[k].coarse);
  }
  // A wrong belief leaves out nothing.
  EXPECT_EQ(search.latticeSearch(submap, 1000, Pose2{100.0, 0.0, 0.0}).size(), all.size());
}

TEST(PlaceSearch, endsWhereItIsNotWantedAnyMore) {
  const auto map = room();
  const PlaceSearch search(map);
  const Submap submap = submapOf({look(GridRayCaster(map), {2.0, 2.0, 0.3}, 1.0)}, {{}});
  int asked = 0;
  EXPECT_TRUE(search.search(submap, {}, [&] { return ++asked > 0; }).empty());
  EXPECT_EQ(asked, 1);
}

TEST(PlaceJudge, comparesPlacesAndKeepsWhatIsBelieved) {
  // Surer with the margin, with what is seen and with the length.
  EXPECT_GT(probabilityOfPlace(0.9, 0.5, 5.0), 0.95);
  EXPECT_LT(probabilityOfPlace(0.9, 0.89, 0.0), 0.9);
  EXPECT_LT(probabilityOfPlace(0.8, 0.75, 1.0), probabilityOfPlace(0.8, 0.65, 1.0));
  EXPECT_LE(probabilityOfPlace(0.8, 0.75, 1.0), probabilityOfPlace(0.8, 0.75, 10.0));
  // On no map any place leaves much unexplained, however far the next one is behind.
  EXPECT_LT(probabilityOfPlace(0.5, 0.45, 5.0), probabilityOfPlace(0.9, 0.85, 5.0));
  EXPECT_TRUE(std::isfinite(probabilityOfPlace(1.0, 1.0, 0.0))) << "nothing is left unexplained";

  SearchAnswer answer;
  EXPECT_FALSE(judge(answer));
  const auto place = [](double x, double seen) {
    Place p;
    p.base = {x, 0.0, 0.0};
    p.seen = seen;
    return p;
  };
  answer.length = 5.0;
  answer.places = {place(1, 0.5), place(30, 0.4), place(60, 0.1)};
  answer.believed = place(1.2, 0.45);
  auto v = judge(answer);
  ASSERT_TRUE(v);
  EXPECT_TRUE(v->best_is_believed) << "a low share alone says nothing";
  EXPECT_EQ(v->hypotheses.size(), 2U);
  answer.believed = place(100, 0.2);  // the search did not even find it
  v = judge(answer);
  EXPECT_FALSE(v->best_is_believed);
  EXPECT_EQ(v->best.base.x, 1.0);
  answer.believed = place(100, 0.6);
  EXPECT_TRUE(judge(answer)->best_is_believed);
}

TEST(Localizer, keepsARightPoseInClutterThatTheMapLacks) {
  const auto map = room();
  const GridRayCaster rays(map);
  LocalizerParams params;
  for (const bool search : {true, false}) {
    params.submap_search = search;
    Localizer localizer(map, params);
    localizer.setInitialPose({2.0, 2.0, 0.0}, {0.2, 0.2, 0.1});
    Pose2 at{2.0, 2.0, 0.0};
    int alarms = 0;
    double worst = 0.0;
    for (int i = 0; i < 400; ++i) {
      at = at * Pose2{0.02, 0.0, i < 60 ? 0.0 : 0.02};  // a circle of 1 m
      hyselam::LaserScan scan = look(rays, at, 0.1 * i);
      for (std::size_t b = 0; i > 130 && b < scan.ranges.size(); ++b) {  // people around it
        if (b / 8 % 3 == 0) scan.ranges[b] = std::min(scan.ranges[b], 0.7F);
      }
      const auto result = localizer.update(scan, at);
      if (!result || i < 100) continue;
      alarms += result->phase == Phase::kLost;
      worst = std::max(worst, distance(result->base_in_map, at));
    }
    if (search) {
      EXPECT_EQ(alarms, 0);
      EXPECT_LT(worst, 0.3);
    } else {
      EXPECT_GT(alarms, 0) << "the clutter is too little to tell anything";
    }
  }
}

TEST(Localizer, oneOddScanRaisesNoDoubt) {
  const auto map = room();
  const GridRayCaster rays(map);
  Localizer localizer(map, LocalizerParams{});
  Pose2 at{1.5, 2.0, 0.0};
  localizer.setInitialPose(at, {0.2, 0.2, 0.1});
  bool was_sure = false;
  for (int i = 0; i < 28; ++i) {
    at = at * Pose2{0.101, 0.0, 0.0};  // each scan is an update
    hyselam::LaserScan scan = look(rays, at, 0.3 * i);
    for (std::size_t b = 0; i == 20 && b < 120; ++b) {  // somebody stands before the laser
      scan.ranges[b] = std::min(scan.ranges[b], 0.6F);
    }
    const auto result = localizer.update(scan, at);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->converged || !was_sure) << "at scan " << i;
    was_sure = result->converged;
  }
  EXPECT_TRUE(was_sure);
}

TEST(Localizer, whatWasSeenBeforeItWasCarriedOffDoesNotMislead) {
  DrivenRobot robot;
  double wrong = 0.0;
  std::optional<LocalizationResult> last;
  for (int i = 0; i < 400; ++i) {
    robot.drive({0.02, 0.0, 0.02});  // a circle of 1 m, in 6.3 m
    if (i == 315) robot.carryOff();
    const auto result = robot.see(0.1 * i);
    if (!result) continue;
    if (i >= 315 && result->converged && distance(result->base_in_map, robot.at) > 0.5) {
      wrong += result->travelled - last->travelled;
    }
    last = result;
  }
  EXPECT_LT(wrong, 0.3) << "sure of a wrong pose for so many metres";
  EXPECT_TRUE(last->converged);
  EXPECT_LT(distance(last->base_in_map, robot.at), 0.2);
}

TEST(Localizer, keepsItsPoseOnCellsThatTheMapDoesNotKnow) {
  auto map = room();
  const GridRayCaster rays(map);
  // The robot drives through a patch that nobody has seen when the map was made.
  const auto& g = map.geometry;
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const Point2 p = g.center({x, y});
      if (map.at({x, y}) == 0 && std::hypot(p.x - 3.0, p.y - 3.0) < 0.6) map.at({x, y}) = -1;
    }
  }
  Localizer localizer(map, LocalizerParams{});
  Pose2 at{2.0, 2.0, 0.0};
  localizer.setInitialPose(at, {0.1, 0.1, 0.05});
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    at = at * Pose2{0.02, 0.0, 0.02};
    const auto result = localizer.update(look(rays, at, 0.1 * i), at);
    if (result && i > 30) worst = std::max(worst, distance(result->base_in_map, at));
  }
  EXPECT_LT(worst, 0.12);
}

TEST(Localizer, isFoundStandingStillWhereOneScanDecides) {
  const auto map = room();
  const GridRayCaster rays(map);
  Localizer localizer(map, LocalizerParams{});
  const Pose2 at{9.0, 6.0, -2.0};
  std::optional<LocalizationResult> last;
  for (int i = 0; i < 20; ++i) {
    if (const auto r = localizer.update(look(rays, at, 0.1 * i), {})) last = r;
  }
  ASSERT_TRUE(last);
  EXPECT_EQ(last->phase, Phase::kTracking);
  EXPECT_TRUE(last->converged);
  EXPECT_LT(distance(last->base_in_map, at), 0.1);
}

TEST(Localizer, aPlaceThatIsOnlySupposedDoesNotLookCertain) {
  const auto map = room();
  const GridRayCaster rays(map);
  LocalizerParams params;
  params.found_probability = 1.0 - 1e-12;  // nothing is so sure
  Localizer localizer(map, params);
  Pose2 at{2.0, 2.0, 0.0};
  std::optional<LocalizationResult> last;
  for (int i = 0; i < 60; ++i) {
    at = at * Pose2{0.05, 0.0, 0.0};
    if (const auto r = localizer.update(look(rays, at, 0.1 * i), at)) last = r;
  }
  ASSERT_TRUE(last);
  EXPECT_FALSE(last->converged);
  EXPECT_LT(distance(last->base_in_map, at), 0.3) << "the place is the right one";
  EXPECT_EQ(last->cluster_weight, 1.0) << "and the only one";
  EXPECT_GE(last->covariance(0, 0), 1.0);
  EXPECT_GE(last->covariance(1, 1), 1.0);
}

// Distance map and Voronoi diagram against their definitions, and updated against rebuilt.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_gr2to/thesis/distance_map.hpp"
#include "hyselam_gr2to/thesis/voronoi.hpp"
#include "transcription/voronoi.hpp"
#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

using hyselam::Cell;
using hyselam_topo::DistanceMap;
using hyselam_topo::VoronoiDiagram;

namespace {

// Single cells and boxes; sparse to dense, down to no obstacle at all.
cv::Mat randomObstacles(std::uint64_t seed, int largest = 40) {
  hyselam::Rng rng(seed);
  const int w = 1 + static_cast<int>(rng.below(static_cast<std::uint32_t>(largest)));
  const int h = 1 + static_cast<int>(rng.below(static_cast<std::uint32_t>(largest)));
  cv::Mat m(h, w, CV_8UC1, cv::Scalar(0));
  const double density = std::pow(10.0, rng.uniform(-4.0, -0.3));
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) m.at<std::uint8_t>(y, x) = rng.uniform() < density ? 1 : 0;
  }
  for (std::uint32_t k = rng.below(4); k > 0; --k) {
    const int x = static_cast<int>(rng.below(static_cast<std::uint32_t>(w))),
              y = static_cast<int>(rng.below(static_cast<std::uint32_t>(h)));
    m(cv::Rect(x, y, std::min(w - x, 2 + static_cast<int>(rng.below(20))),
               std::min(h - y, 1 + static_cast<int>(rng.below(5)))))
        .setTo(7);
  }
  return m;
}

// Empty if both tell the same of every cell.
std::string difference(const DistanceMap& map, const cv::Mat& sites) {
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const cv::Vec2i s = sites.at<cv::Vec2i>(y, x);
      const Cell site = map.site({x, y});
      const long squared =
          s[0] < 0 ? DistanceMap::kFar : transcription::squaredDistance({x, y}, {s[0], s[1]});
      if (site.x == s[0] && site.y == s[1] && map.squared({x, y}) == squared) continue;
      return "cell " + std::to_string(x) + ", " + std::to_string(y) + ": site " +
             std::to_string(site.x) + ", " + std::to_string(site.y) + " instead of " +
             std::to_string(s[0]) + ", " + std::to_string(s[1]);
    }
  }
  return "";
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

// Boxes and single cells set or cleared.
void randomEdits(hyselam::Rng& rng, cv::Mat& obstacles) {
  const auto upTo = [&](int n) {
    return static_cast<int>(rng.below(static_cast<std::uint32_t>(n)));
  };
  for (int k = 1 + upTo(4); k > 0; --k) {
    const int x = upTo(obstacles.cols), y = upTo(obstacles.rows);
    const int side = rng.uniform() < 0.5 ? 1 : 8;
    obstacles(cv::Rect(x, y, std::min(obstacles.cols - x, 1 + upTo(side)),
                       std::min(obstacles.rows - y, 1 + upTo(side))))
        .setTo(rng.uniform() < 0.5 ? 1 : 0);
  }
}

}  // namespace

TEST(DistanceMap, EqualsBruteForceOnRandomMaps) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const cv::Mat obstacles = randomObstacles(seed);
    ASSERT_EQ("", difference(DistanceMap(obstacles), transcription::nearestObstacles(obstacles)))
        << "seed " << seed;
  }
}

TEST(DistanceMap, UpdatedEqualsBruteForceAfterRandomEdits) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    hyselam::Rng rng(seed, 1);
    cv::Mat obstacles = randomObstacles(seed);
    DistanceMap map(obstacles);
    for (int step = 0; step < 12; ++step) {
      const cv::Mat before = transcription::nearestObstacles(obstacles);
      randomEdits(rng, obstacles);
      const auto spans = map.update(obstacles);
      const cv::Mat after = transcription::nearestObstacles(obstacles);
      ASSERT_EQ("", difference(map, after)) << "seed " << seed << ", step " << step;
      // Whatever has changed is told, once.
      cv::Mat told(obstacles.size(), CV_8UC1, cv::Scalar(0));
      for (const auto& s : spans) {
        for (int x = s.first; x <= s.last; ++x) ++told.at<std::uint8_t>(s.y, x);
      }
      for (int y = 0; y < obstacles.rows; ++y) {
        for (int x = 0; x < obstacles.cols; ++x) {
          ASSERT_LE(told.at<std::uint8_t>(y, x), 1);
          if (before.at<cv::Vec2i>(y, x) != after.at<cv::Vec2i>(y, x)) {
            ASSERT_EQ(1, told.at<std::uint8_t>(y, x)) << "seed " << seed << ", step " << step;
          }
        }
      }
    }
  }
}

TEST(DistanceMap, SmallEditsUpdateFewCells) {
  cv::Mat obstacles(400, 400, CV_8UC1, cv::Scalar(0));
  for (int i = 0; i < 400; i += 20) {
    obstacles.row(i).setTo(1);
    obstacles.col(i).setTo(1);
  }
  DistanceMap map(obstacles);
  map.setObstacle({210, 210}, true);
  int cells = 0;
  for (const auto& s : map.update()) cells += s.last - s.first + 1;
  EXPECT_GT(cells, 20);
  EXPECT_LT(cells, 19 * 19 + 1);
  EXPECT_TRUE(map.update().empty());
}

TEST(DistanceMap, WithoutObstaclesDistancesAreInfinite) {
  DistanceMap map(cv::Mat(3, 5, CV_8UC1, cv::Scalar(0)));
  EXPECT_EQ(DistanceMap::kFar, map.squared({4, 2}));
  EXPECT_TRUE(std::isinf(map.distance({0, 0})));
  EXPECT_EQ((Cell{-1, -1}), map.site({0, 0}));
  map.setObstacle({1, 1}, true);
  map.setObstacle({-1, 7}, true);  // outside: ignored
  map.update();
  EXPECT_EQ(9 + 1, map.squared({4, 2}));
  EXPECT_EQ((Cell{1, 1}), map.site({4, 2}));
}

TEST(DistanceMap, RefusesInvalidImages) {
  EXPECT_THROW(DistanceMap{cv::Mat()}, hyselam::InputError);
  EXPECT_THROW(DistanceMap(cv::Mat(3, 3, CV_32F)), hyselam::InputError);
  EXPECT_THROW(DistanceMap(cv::Mat(1, 40000, CV_8U, cv::Scalar(0))), hyselam::InputError);
  DistanceMap map(cv::Mat(3, 5, CV_8UC1, cv::Scalar(0)));
  EXPECT_THROW(map.update(cv::Mat(5, 3, CV_8UC1, cv::Scalar(0))), hyselam::InputError);
}

TEST(Voronoi, EqualsItsDefinitionOnRandomMaps) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const cv::Mat obstacles = randomObstacles(seed, 60);
    hyselam_topo::VoronoiParams params;
    params.noise = seed % 3 == 0 ? 0.75 : seed % 3 == 1 ? 1.5 : 3.1;
    const VoronoiDiagram voronoi(DistanceMap(obstacles), params);
    const cv::Mat borders =
        transcription::voronoiBorders(transcription::nearestObstacles(obstacles), params.noise);
    ASSERT_TRUE(same(borders, voronoi.borders())) << "seed " << seed;
    ASSERT_TRUE(same(transcription::thinned(borders), voronoi.lines())) << "seed " << seed;
  }
}

TEST(Voronoi, UpdatedEqualsRebuiltAfterRandomEdits) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    hyselam::Rng rng(seed, 2);
    cv::Mat obstacles = randomObstacles(seed, 150);
    DistanceMap map(obstacles);
    VoronoiDiagram voronoi(map);
    for (int step = 0; step < 15; ++step) {
      randomEdits(rng, obstacles);
      voronoi.update(map, map.update(obstacles));
      const VoronoiDiagram fresh{DistanceMap(obstacles)};
      ASSERT_TRUE(same(fresh.borders(), voronoi.borders())) << "seed " << seed << ", " << step;
      ASSERT_TRUE(same(fresh.lines(), voronoi.lines())) << "seed " << seed << ", " << step;
    }
  }
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
RC_GTEST_PROP(VoronoiProperty, EditsInAnyOrderEqualFromScratch, ()) {
  const int w = *rc::gen::inRange(1, 70), h = *rc::gen::inRange(1, 70);
  cv::Mat obstacles(h, w, CV_8UC1, cv::Scalar(0));
  DistanceMap map(obstacles);
  VoronoiDiagram voronoi(map);
  const auto edits = *rc::gen::container<std::vector<std::tuple<int, int, bool>>>(
      rc::gen::tuple(rc::gen::inRange(0, w), rc::gen::inRange(0, h), rc::gen::arbitrary<bool>()));
  std::size_t k = 0;
  for (const auto& [x, y, value] : edits) {
    obstacles.at<std::uint8_t>(y, x) = value ? 1 : 0;
    map.setObstacle({x, y}, value);
    if (++k % 5 == 0) voronoi.update(map, map.update());
  }
  voronoi.update(map, map.update());
  const DistanceMap fresh(obstacles);
  RC_ASSERT(cv::countNonZero(fresh.squaredView() != map.squaredView()) == 0);
  RC_ASSERT(same(VoronoiDiagram(fresh).lines(), voronoi.lines()));
}
#endif

// Two rooms and a door: the diagram leads through the door.
TEST(Voronoi, IsALineThroughADoor) {
  cv::Mat obstacles(40, 81, CV_8UC1, cv::Scalar(0));
  obstacles.row(0).setTo(1);
  obstacles.row(39).setTo(1);
  obstacles.col(0).setTo(1);
  obstacles.col(80).setTo(1);
  obstacles.colRange(38, 42).setTo(1);
  obstacles(cv::Rect(38, 15, 4, 9)).setTo(0);
  const VoronoiDiagram voronoi{DistanceMap(obstacles)};
  for (int x = 34; x < 46; ++x) {
    EXPECT_EQ(1, cv::countNonZero(voronoi.lines()(cv::Rect(x, 12, 1, 15)))) << x;
    EXPECT_EQ(255, voronoi.lines().at<std::uint8_t>(19, x)) << x;
  }
}

// A slanted wall, drawn in steps, has no branches of its own.
TEST(Voronoi, StepsOfSlantedWallsMakeNoBranches) {
  cv::Mat obstacles(60, 300, CV_8UC1, cv::Scalar(0));
  for (int x = 0; x < 300; ++x) {
    obstacles.col(x).rowRange(0, 2 + x / 17).setTo(1);
    obstacles.col(x).rowRange(40 + x / 17, 60).setTo(1);
  }
  const VoronoiDiagram voronoi{DistanceMap(obstacles)};
  for (int x = 40; x < 260; ++x) EXPECT_EQ(1, cv::countNonZero(voronoi.lines().col(x))) << x;
}

TEST(Voronoi, RefusesNoiseOutOfRange) {
  hyselam_topo::VoronoiParams params;
  params.noise = 0.1;
  EXPECT_THROW(VoronoiDiagram(DistanceMap(cv::Mat(3, 3, CV_8UC1, cv::Scalar(0))), params),
               hyselam::ParameterError);
}

// The bucketed ray caster against a search through all segments.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hyselam_common/rng.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/plan_ray_caster.hpp"

#ifdef HYSELAM_HAVE_RAPIDCHECK
#include <rapidcheck.h>
#endif

namespace hyselam_sim {
namespace {

// A different way to the same figure: turn the world so that the ray is the x axis.
double slowCast(const std::vector<Segment>& segments, Point2 origin, double angle, double max_range,
                bool& doubtful) {
  double best = max_range;
  const Pose2 ray{origin.x, origin.y, angle};
  for (const Segment& s : segments) {
    const Point2 a = ray.inverse() * s.a, b = ray.inverse() * s.b;
    if (std::abs(a.y) < 1e-7 || std::abs(b.y) < 1e-7) doubtful = true;  // through an end point
    if ((a.y > 0) == (b.y > 0)) continue;
    const double x = a.x + (b.x - a.x) * (a.y / (a.y - b.y));
    if (std::abs(x) < 1e-7) doubtful = true;  // begins on a segment
    if (x >= 0.0 && x < best) best = x;
  }
  return best;
}

struct World {
  std::vector<Segment> segments;
  double bucket_size;
};

World randomWorld(hyselam::Rng& rng) {
  World world;
  const double side = rng.uniform(1.0, 60.0);
  const int n = static_cast<int>(rng.below(150));
  for (int i = 0; i < n; ++i) {
    const Point2 a{rng.uniform(-side, side), rng.uniform(-side, side)};
    const double reach = rng.below(2) ? 2.0 : side;
    Point2 b = a + Point2{rng.uniform(-reach, reach), rng.uniform(-reach, reach)};
    if (rng.below(3) == 0) b.x = a.x;  // buildings are made of these
    if (rng.below(3) == 0) b.y = a.y;
    world.segments.push_back({a, b});
  }
  world.bucket_size = rng.uniform(0.2, 5.0);
  return world;
}

// Compares `rays` rays in one random world; returns how many could be compared.
int compareInRandomWorld(std::uint64_t seed, int rays) {
  hyselam::Rng rng(seed);
  const World world = randomWorld(rng);
  const PlanRayCaster caster(world.segments, world.bucket_size);
  int compared = 0;
  for (int i = 0; i < rays; ++i) {
    const Point2 origin{rng.uniform(-70.0, 70.0), rng.uniform(-70.0, 70.0)};
    const double angle = rng.below(4) == 0 ? rng.below(8) * hyselam::kPi / 4.0
                                           : rng.uniform(-hyselam::kPi, hyselam::kPi);
    const double max_range = rng.uniform(0.5, 100.0);
    bool doubtful = false;
    const double expected = slowCast(world.segments, origin, angle, max_range, doubtful);
    if (doubtful) continue;
    ++compared;
    const double got = caster.cast(origin, {std::cos(angle), std::sin(angle)}, max_range);
    EXPECT_NEAR(got, expected, 1e-6) << "seed " << seed << ", ray " << i;
  }
  return compared;
}

TEST(RayCaster, EqualsSearchThroughAllSegmentsOn20000Rays) {
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) compared += compareInRandomWorld(seed, 100);
  EXPECT_GT(compared, 19000);
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
TEST(RayCaster, EqualsSearchThroughAllSegmentsProperty) {
  EXPECT_TRUE(rc::check("100 worlds of 100 rays", [](std::uint64_t seed) {
    compareInRandomWorld(seed, 100);
    RC_ASSERT(!testing::Test::HasFailure());
  }));
}
#endif

TEST(RayCaster, SeesEveryShippedPlanAsTheSlowSearchDoes) {
  for (const std::string& name : shippedPlans()) {
    const FloorPlan plan = loadFloorPlan(planFile(name));
    const std::vector<Segment> segments = edges(solids(plan, 0.0));
    const PlanRayCaster caster(segments);
    hyselam::Rng rng(5);
    for (const PlanPlace& place : plan.places) {
      for (int i = 0; i < 200; ++i) {
        const double angle = rng.uniform(-hyselam::kPi, hyselam::kPi);
        bool doubtful = false;
        const double expected = slowCast(segments, place.at, angle, 30.0, doubtful);
        if (doubtful) continue;
        EXPECT_NEAR(caster.cast(place.at, {std::cos(angle), std::sin(angle)}, 30.0), expected, 1e-6)
            << name << ", " << place.name;
      }
    }
  }
}

TEST(RayCaster, EmptyWorldReturnsMaximum) {
  EXPECT_EQ(PlanRayCaster({}).cast({0, 0}, {1, 0}, 8.0), 8.0);
}

TEST(RayCaster, OneSegmentLongerThanManyBuckets) {
  const PlanRayCaster caster({{{-100, 3}, {100, 3}}}, 0.5);
  EXPECT_DOUBLE_EQ(caster.cast({0, 0}, {0, 1}, 10.0), 3.0);
  EXPECT_EQ(caster.cast({0, 0}, {0, -1}, 10.0), 10.0);
  EXPECT_EQ(caster.cast({0, 0}, {1, 0}, 10.0), 10.0);
}

TEST(HitDistance, Disc) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(hitDistance({0, 0}, {1, 0}, Point2{5, 0}, 1.0), 4.0);
  EXPECT_EQ(hitDistance({0, 0}, {-1, 0}, Point2{5, 0}, 1.0), inf);
  EXPECT_EQ(hitDistance({0, 0}, {1, 0}, Point2{5, 1.01}, 1.0), inf);
  EXPECT_EQ(hitDistance({5, 0.5}, {1, 0}, Point2{5, 0}, 1.0), 0.0);
}

}  // namespace
}  // namespace hyselam_sim

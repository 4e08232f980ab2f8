// Generated plans are usable plans: they load, their doors lead from place to place, and nothing
// about them changes by chance.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace hyselam_sim {
namespace {

constexpr std::uint64_t kSeeds = 40;

// The place whose outline holds a point; -1 for none.
int placeOf(const FloorPlan& plan, Point2 p) {
  for (std::size_t i = 0; i < plan.places.size(); ++i) {
    if (contains(plan.places[i].outline, p)) return static_cast<int>(i);
  }
  return -1;
}

TEST(GeneratedPlan, DoorsLeadFromPlaceToPlaceAndReachAll) {
  std::set<int> widths;
  std::size_t openings = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PlanParams params;
    params.rotation = seed % 2 == 0 ? 0.0 : 0.3;
    const FloorPlan plan = generatePlan(seed, params);
    std::vector<int> group(plan.places.size());
    for (std::size_t i = 0; i < group.size(); ++i) group[i] = static_cast<int>(i);
    for (const PlanDoor& door : plan.doors) {
      const Point2 across{-door.along.y, door.along.x};
      for (const double s : {-0.45, 0.0, 0.45}) {
        const Point2 at = door.at + (s * door.width) * door.along;
        const int a = placeOf(plan, at + 0.2 * across), b = placeOf(plan, at - 0.2 * across);
        ASSERT_GE(a, 0) << "seed " << seed << ", " << door.name;
        ASSERT_GE(b, 0) << "seed " << seed << ", " << door.name;
        ASSERT_NE(a, b) << "seed " << seed << ", " << door.name;
        const int from = group[static_cast<std::size_t>(a)],
                  to = group[static_cast<std::size_t>(b)];
        std::replace(group.begin(), group.end(), from, to);
      }
      const bool opening = door.name.rfind(kOpeningPrefix, 0) == 0;
      openings += opening ? 1 : 0;
      if (opening) continue;
      EXPECT_GE(door.width, 0.7 - 1e-9) << "seed " << seed << ", " << door.name;
      EXPECT_LE(door.width, 2.0 + 1e-9) << "seed " << seed << ", " << door.name;
      widths.insert(static_cast<int>(door.width * 10.0 + 0.01));
    }
    EXPECT_EQ(1u, std::set<int>(group.begin(), group.end()).size()) << "seed " << seed;
  }
  EXPECT_GE(widths.size(), 12u) << "narrow and wide doors";
  EXPECT_GE(openings, 10u);
}

TEST(GeneratedPlan, IsReadBackAsItWasWritten) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PlanParams params;
    params.furniture = true;
    params.rotation = 0.01 * static_cast<double>(seed);
    const FloorPlan plan = generatePlan(seed, params);
    const std::string text = toYaml(plan);
    const FloorPlan again = parseFloorPlan(text, plan.name);
    const auto a = rasterize(plan), b = rasterize(again);
    ASSERT_EQ(plan.doors.size(), again.doors.size());
    EXPECT_EQ(a.cells, b.cells) << "seed " << seed;
    EXPECT_EQ(text, toYaml(generatePlan(seed, params))) << "the same seed, another plan";
  }
}

TEST(GeneratedPlan, FurnitureLeavesDoorsFree) {
  std::size_t pieces = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    PlanParams params;
    params.furniture = true;
    const FloorPlan plan = generatePlan(seed, params);
    pieces += plan.furniture.size();
    for (const Furniture& item : plan.furniture) {
      ASSERT_GE(placeOf(plan, 0.5 * (item.outline[0] + item.outline[2])), 0);
      for (const PlanDoor& door : plan.doors) {
        for (const Point2& p : item.outline) {
          EXPECT_GT(length(p - door.at), 0.5 * door.width + 0.8) << "seed " << seed << item.name;
        }
      }
    }
  }
  EXPECT_GE(pieces, kSeeds);
}

TEST(GeneratedPlan, RefusesParametersOutOfRange) {
  PlanParams params;
  params.min_door = 0.1;
  EXPECT_THROW(generatePlan(1, params), hyselam::ParameterError);
  params.min_door = 1.5;
  params.max_door = 1.0;
  EXPECT_THROW(generatePlan(1, params), hyselam::ParameterError);
  params = PlanParams();
  params.rotation = std::nan("");
  EXPECT_THROW(generatePlan(1, params), hyselam::ParameterError);
}

}  // namespace
}  // namespace hyselam_sim

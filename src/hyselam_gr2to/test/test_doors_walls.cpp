// Doors and walls of simulated floor plans, whose places are known, against the plans.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/map_builder/borders.hpp"
#include "hyselam_gr2to/map_builder/doors.hpp"
#include "hyselam_gr2to/map_builder/map_builder.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "plan_truth.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header

namespace {

struct Case {
  bool furniture;
  double rotation;
  double resolution;
  double shift;  // of the borders from the doorways [m]
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << (c.furniture ? "furnished" : "empty") << ", turned by " << c.rotation
             << ", cells of " << c.resolution;
}

class SimulatedPlans : public ::testing::TestWithParam<Case> {};

}  // namespace

TEST_P(SimulatedPlans, DoorsAndWallsAreFound) {
  const Case c = GetParam();
  plan_truth::Score doors;
  plan_truth::WallScore walls;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    hyselam_sim::PlanParams params;
    params.furniture = c.furniture;
    params.rotation = c.rotation;
    const auto plan = hyselam_sim::generatePlan(seed, params);
    const auto grid = hyselam_sim::rasterize(plan, c.resolution, 0.0);
    PlaceSegmentation s;
    s.labels = plan_truth::labels(plan, grid);
    if (c.shift > 0.0) plan_truth::shiftBorders(plan, grid, c.shift, &s.labels);
    s.places = static_cast<int>(plan.places.size());
    s.doors = refineDoors(grid, s.labels);
    std::vector<std::string> mistakes;
    doors += plan_truth::scoreDoors(plan, s.doors, &mistakes);
    for (const auto& m : mistakes) std::cout << "seed " << seed << ": " << m << "\n";

    const AugmentedTopologicalMap map = buildTopologicalMap(grid, s);
    EXPECT_NO_THROW(checkMap(map, "test"));
    std::vector<std::vector<Wall>> found;
    for (const auto& place : map.places) found.push_back(place.walls);
    walls += plan_truth::scoreWalls(plan, c.resolution, c.furniture, found);
    for (std::size_t k = 0; k < plan.places.size(); ++k) {
      const bool corridor = plan.places[k].name == "corridor";
      EXPECT_EQ(corridor, map.places[k].kind == PlaceKind::kCorridor)
          << "seed " << seed << ", " << plan.places[k].name;
    }
  }
  std::cout << c << ": doors precision " << doors.precision() << " recall " << doors.recall()
            << " (" << doors.truth << "), walls of the plan " << walls.true_near / walls.true_length
            << ", walls found " << walls.found_near / walls.found_length << "\n";
  EXPECT_GE(doors.precision(), 0.95);
  EXPECT_GE(doors.recall(), 0.95);
  if (c.shift > 0.3) return;  // places with borders in the middle of a room have other walls
  EXPECT_GE(walls.true_near / walls.true_length, 0.95);
  EXPECT_GE(walls.found_near / walls.found_length, 0.95);
}

INSTANTIATE_TEST_SUITE_P(Plans, SimulatedPlans,
                         ::testing::Values(Case{false, 0.0, 0.05, 0.0}, Case{true, 0.0, 0.05, 0.0},
                                           Case{false, 0.3, 0.05, 0.0}, Case{true, 0.3, 0.05, 0.0},
                                           Case{false, 0.0, 0.1, 0.0}, Case{false, 0.3, 0.02, 0.0},
                                           Case{false, 0.0, 0.05, 0.3}, Case{true, 0.3, 0.05, 0.3},
                                           Case{true, 0.0, 0.05, 0.6}));

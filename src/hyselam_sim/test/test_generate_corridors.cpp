// Made-up corridors are usable buildings, and what they say about their places is true.
#include <gtest/gtest.h>

#include <map>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_sim/simulation.hpp"

namespace hyselam_sim {
namespace {

constexpr std::uint64_t kSeeds = 25;

Point2 middleOf(const Area& area) {
  return 0.5 * (area.outline[0] + area.outline[2]);
}

TEST(GeneratedCorridors, AreClosedBuildingsWithEveryKindOfPlace) {
  std::map<std::string, int> kinds;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const CorridorBuilding building = generateCorridors(seed);
    const auto grid = rasterize(building.plan);  // refuses what leaks
    for (const Area& area : building.plan.areas) {
      ++kinds[area.kind];
      const auto cell = grid.geometry.cellAt(middleOf(area));
      EXPECT_EQ(grid.valueOr(cell), hyselam::OccupancyGrid::kFree) << area.kind;
      EXPECT_EQ(building.plan.kindAt(middleOf(area)), area.kind);
    }
    for (const PlanPlace& place : building.plan.places) {
      const std::string& kind = building.plan.kindAt(place.at);
      if (place.name.rfind("end", 0) == 0) {
        EXPECT_EQ(kind, "dead-end") << place.name;
      } else if (place.name.rfind("corridor", 0) == 0) {
        EXPECT_EQ(kind, "corridor") << place.name;
      } else {
        EXPECT_NE(kind, "dead-end") << place.name;
      }
    }
  }
  for (const std::string& kind : areaKinds())
    EXPECT_GE(kinds[kind], kind == "corridor" ? 0 : 10) << kind;
}

// As many ways lead out of a place as its kind says.
TEST(GeneratedCorridors, KindsFollowFromTheWaysOut) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    CorridorParams params;
    params.halls = params.rooms = 0.0;
    const CorridorBuilding building = generateCorridors(seed, params);
    const auto grid = rasterize(building.plan);
    const auto isFree = [&](Point2 p) {
      return grid.valueOr(grid.geometry.cellAt(p)) == hyselam::OccupancyGrid::kFree;
    };
    for (const Area& area : building.plan.areas) {
      const Point2 m = middleOf(area);
      const bool east = isFree({m.x + 3.0, m.y}), west = isFree({m.x - 3.0, m.y}),
                 north = isFree({m.x, m.y + 3.0}), south = isFree({m.x, m.y - 3.0});
      const int ways = east + west + north + south;
      if (area.kind == "dead-end") {
        EXPECT_EQ(ways, 1);
      } else if (area.kind == "bifurcation") {
        EXPECT_GE(ways, 3);
      } else {
        EXPECT_EQ(ways, 2);
        EXPECT_NE(east, west);
      }
    }
  }
}

TEST(GeneratedCorridors, RoutesCanBeDriven) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    CorridorParams params;
    params.legs = 20;
    const CorridorBuilding building = generateCorridors(seed, params);
    SimulationParams simulation;
    simulation.scan_rate = 1.0;  // not looked at
    const Simulation run = simulate(building.plan, building.route, seed, simulation);
    EXPECT_GE(run.visits.size(), 20u);
    EXPECT_GT(run.distance, 20 * 7.0);
  }
}

TEST(GeneratedCorridors, AreTheSameFromTheSameSeedAndCanBeWritten) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const FloorPlan plan = generateCorridors(seed).plan;
    const std::string text = toYaml(plan);
    EXPECT_EQ(text, toYaml(generateCorridors(seed).plan));
    const FloorPlan again = parseFloorPlan(text, "again");
    EXPECT_EQ(rasterize(plan).cells, rasterize(again).cells);
    ASSERT_EQ(plan.areas.size(), again.areas.size());
    EXPECT_EQ(again.kindAt(middleOf(plan.areas[0])), plan.areas[0].kind);
    EXPECT_EQ(again.floor_kind, "corridor");
  }
  EXPECT_NE(toYaml(generateCorridors(1).plan), toYaml(generateCorridors(2).plan));
}

TEST(GeneratedCorridors, ParametersOutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    CorridorParams params;
    change(params);
    try {
      generateCorridors(1, params);
      return false;
    } catch (const hyselam::ParameterError&) {
      return true;
    }
  };
  EXPECT_TRUE(refused([](CorridorParams& p) { p.lines = 1; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.min_width = 0.5; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.max_width = 1.0; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.min_spacing = 4.0; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.max_spacing = 5.0; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.halls = -0.1; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.rooms = 2.0; }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.loops = std::nan(""); }));
  EXPECT_TRUE(refused([](CorridorParams& p) { p.legs = 0; }));
}

TEST(ShippedAreas, TellWhatTheScenariosOfChapter6AreMadeOf) {
  const auto counts = [](const std::string& name) {
    std::map<std::string, int> out;
    const FloorPlan plan = loadFloorPlan(planFile(name));
    for (const Area& area : plan.areas) ++out[area.kind];
    EXPECT_EQ(plan.floor_kind, "corridor");
    return out;
  };
  using Counts = std::map<std::string, int>;
  EXPECT_EQ(counts("ngram_a"), (Counts{{"bifurcation", 5}, {"corner", 4}}));
  EXPECT_EQ(counts("ngram_b"), (Counts{{"bifurcation", 12}, {"corner", 11}}));
  EXPECT_EQ(counts("university"), (Counts{{"bifurcation", 2}, {"corner", 4}}));
}

}  // namespace
}  // namespace hyselam_sim

// Made-up corridors are usable buildings, and what they say about their places is true.
#include <gtest/gtest.h>

#include <map>

#include "hyselam_common/checksum.hpp"
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

// Offices are rooms with one door, entered by the route; things stand in halls and offices only.
TEST(GeneratedCorridors, HaveOfficesAndFurnitureIfWanted) {
  CorridorParams params;
  params.legs = 12;
  params.halls = 0.5;
  params.max_hall = 20.0;
  params.min_spacing = 10.0;
  params.max_spacing = 26.0;
  params.offices = 0.8;
  params.furniture = 0.15;
  int entered = 0, things = 0, driven = 0;
  double widest = 0.0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const CorridorBuilding building = generateCorridors(seed, params);
    const auto grid = rasterize(building.plan);  // refuses what leaks
    int offices = 0;
    for (const PlanPlace& place : building.plan.places) {
      if (place.name.rfind("office", 0) != 0) continue;
      ++offices;
      EXPECT_EQ(building.plan.kindAt(place.at), "dead-end") << place.name;
      EXPECT_EQ(grid.valueOr(grid.geometry.cellAt(place.at)), hyselam::OccupancyGrid::kFree);
    }
    EXPECT_GT(offices, 3);
    for (const Area& area : building.plan.areas) {
      if (area.kind == "hall") widest = std::max(widest, area.outline[1].x - area.outline[0].x);
    }
    for (const Furniture& thing : building.plan.furniture) {
      const Point2 middle = 0.5 * (thing.outline[0] + thing.outline[2]);
      const std::string& kind = building.plan.kindAt(middle);
      EXPECT_TRUE(kind == "hall" || kind == "dead-end") << thing.name << " in " << kind;
      ++things;
    }
    for (const RouteStep& step : building.route.steps) {
      entered += step.spot.place.rfind("office", 0) == 0 ? 1 : 0;
    }
    try {
      driven += simulate(building.plan, building.route, seed).visits.size() ==
                building.route.steps.size();
    } catch (const hyselam::InputError&) {  // things block the way
    }
  }
  EXPECT_GT(widest, 12.0);
  EXPECT_GT(entered, 20);
  EXPECT_GT(things, 50);
  EXPECT_GE(driven, 5);
}

// What is not wanted changes nothing: models name the buildings that they were learnt in by seeds.
TEST(GeneratedCorridors, AreTheSameWithoutOfficesAndFurniture) {
  std::string all;
  for (std::uint64_t seed = 0; seed < 5; ++seed) all += toYaml(generateCorridors(seed).plan);
  EXPECT_EQ(hyselam::crc32Text(all), "0612e399");
}

}  // namespace
}  // namespace hyselam_sim

// Reading plans, doors by the clock, and the maps that plans give.
#include <gtest/gtest.h>

#include <functional>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace hyselam_sim {
namespace {

using hyselam::OccupancyGrid;

// A room of 4 x 3 m inside its walls' centre lines, cut by a wall with a door in the middle.
const char* const kRoom = R"(plan: room
size: [6, 5]
origin: [-1, -1]
wall_thickness: 0.2
walls:
  - {name: outer, closed: true, points: [[0, 0], [4, 0], [4, 3], [0, 3]]}
  - {name: middle, points: [[2, 0], [2, 3]]}
doors:
  - {name: door, at: [2, 1.5], width: 1.0, swing: left, schedule: [{from: 10, open: false}, {from: 20, open: true}]}
furniture:
  - {name: box, box: [3, 2.5, 0.4, 0.2]}
places:
  - {name: left, at: [1, 1]}
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(FloorPlan, ReadsEveryElement) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  EXPECT_EQ(plan.name, "room");
  ASSERT_EQ(plan.walls.size(), 2U);
  EXPECT_EQ(plan.walls[0].segmentCount(), 4U);
  EXPECT_EQ(plan.walls[1].segmentCount(), 1U);
  ASSERT_EQ(plan.doors.size(), 1U);
  EXPECT_EQ(plan.doors[0].swing, PlanDoor::Swing::kLeft);
  EXPECT_NEAR(plan.doors[0].along.y, 1.0, 1e-12);
  EXPECT_EQ(plan.furniture.at(0).outline.size(), 4U);
  EXPECT_EQ(plan.place("left").at.x, 1.0);
}

TEST(FloorPlan, DoorFollowsItsSchedule) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  const PlanDoor& door = plan.doors[0];
  EXPECT_TRUE(door.isOpen(0.0));
  EXPECT_TRUE(door.isOpen(9.99));
  EXPECT_FALSE(door.isOpen(10.0));
  EXPECT_FALSE(door.isOpen(19.99));
  EXPECT_TRUE(door.isOpen(20.0));
  EXPECT_EQ(plan.nextDoorChange(0.0), 10.0);
  EXPECT_EQ(plan.nextDoorChange(10.0), 20.0);
  EXPECT_GT(plan.nextDoorChange(20.0), 1e300);
}

TEST(FloorPlan, OpenLeafStandsOnItsSideAndShutLeafFillsTheOpening) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  // The wall runs upwards, so its left is towards smaller x.
  for (const Point2& p : doorLeaf(plan.doors[0], 0.0)) {
    EXPECT_LE(p.x, 2.0 + 1e-9);
    EXPECT_GE(p.x, 1.0 - 1e-9);
    EXPECT_LE(p.y, 1.0 + kLeafThickness + 1e-9);  // at the hinge, the start of the opening
  }
  for (const Point2& p : doorLeaf(plan.doors[0], 15.0)) {
    EXPECT_NEAR(p.x, 2.0, kLeafThickness);
    EXPECT_GE(p.y, 1.0 - 1e-9);
    EXPECT_LE(p.y, 2.0 + 1e-9);
  }
}

TEST(Rasterise, WallsOccupiedInteriorFreeOutsideUnknown) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  const OccupancyGrid grid = rasterize(plan, 0.1, 0.0);
  const auto at = [&](double x, double y) { return grid.valueOr(grid.geometry.cellAt({x, y})); };
  EXPECT_EQ(grid.geometry.width, 60);
  EXPECT_EQ(grid.geometry.height, 50);
  EXPECT_EQ(at(0.55, 0.55), OccupancyGrid::kFree);
  EXPECT_EQ(at(1.5, 1.02), OccupancyGrid::kOccupied);  // the open leaf
  EXPECT_EQ(at(3.0, 1.0), OccupancyGrid::kFree);       // through the door
  EXPECT_EQ(at(2.0, 1.5), OccupancyGrid::kFree);       // the opening itself
  EXPECT_EQ(at(2.0, 0.5), OccupancyGrid::kOccupied);
  EXPECT_EQ(at(-0.05, 1.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(at(0.05, 1.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(at(0.15, 1.0), OccupancyGrid::kFree);  // the wall ends at 0.1 exactly
  EXPECT_EQ(at(-0.5, 1.0), OccupancyGrid::kUnknown);
  EXPECT_EQ(at(3.0, 2.5), OccupancyGrid::kOccupied);  // the box
  EXPECT_EQ(at(4.95, 3.95), OccupancyGrid::kUnknown);
}

TEST(Rasterise, ShutDoorIsOccupiedAndTheRoomBehindItKnown) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  const OccupancyGrid grid = rasterize(plan, 0.1, 15.0);
  const auto at = [&](double x, double y) { return grid.at(grid.geometry.cellAt({x, y})); };
  EXPECT_EQ(at(2.01, 1.5), OccupancyGrid::kOccupied);
  EXPECT_EQ(at(3.0, 1.0), OccupancyGrid::kFree);
}

TEST(Rasterise, FurnitureCanBeLeftOut) {
  RasterOptions options;
  options.with_furniture = false;
  const OccupancyGrid grid = rasterize(parseFloorPlan(kRoom, "room.yaml"), options);
  EXPECT_EQ(grid.at(grid.geometry.cellAt({3.0, 2.5})), OccupancyGrid::kFree);
}

TEST(Rasterise, RefusesAnOpenBuilding) {
  const FloorPlan plan =
      parseFloorPlan(replaced(kRoom, "closed: true, points: [[0, 0], [4, 0], [4, 3], [0, 3]]",
                              "points: [[0, 0], [4, 0], [4, 3], [0, 3]]"),
                     "room.yaml");
  EXPECT_THROW(rasterize(plan), hyselam::InputError);
}

TEST(Rasterise, RefusesAPlanWithoutInterior) {
  FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  plan.places.clear();
  EXPECT_THROW(rasterize(plan), hyselam::InputError);
}

TEST(Rasterise, RefusesBadResolutions) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  for (const double bad : {0.0, -0.1, 1e-6, 100.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(rasterize(plan, bad, 0.0), hyselam::ParameterError) << bad;
  }
}

// ---- bad input: each case must be refused with a message that names file, key and reason.
struct BadPlan {
  const char* name;
  const char* from;
  const char* to;
  const char* expected;  // part of the message
};

class BadPlanTest : public testing::TestWithParam<BadPlan> {};

TEST_P(BadPlanTest, IsRefusedNamingThePlace) {
  const BadPlan& bad = GetParam();
  try {
    const FloorPlan plan = parseFloorPlan(replaced(kRoom, bad.from, bad.to), "room.yaml");
    rasterize(plan);
    FAIL() << "was accepted";
  } catch (const hyselam::InputError& e) {
    const std::string message = e.what();
    EXPECT_EQ(message.rfind("room.yaml", 0), 0U) << message;
    EXPECT_NE(message.find(bad.expected), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Plan, BadPlanTest,
    testing::Values(
        BadPlan{"BrokenYaml", "size: [6, 5]", "size: [6, 5", "not YAML"},
        BadPlan{"UnknownKey", "wall_thickness: 0.2", "wall_thicknes: 0.2",
                "did you mean 'wall_thickness'?"},
        BadPlan{"UnknownDoorKey", "swing: left", "swings: left", "doors[0].swings"},
        BadPlan{"RepeatedKey", "plan: room", "plan: room\nplan: room", "given twice"},
        BadPlan{"MissingSize", "size: [6, 5]\n", "", "'size': missing"},
        BadPlan{"NegativeSize", "size: [6, 5]", "size: [6, -5]", "must be positive"},
        BadPlan{"NanPoint", "[2, 0], [2, 3]", "[.nan, 0], [2, 3]", "must be a finite number"},
        BadPlan{"InfinitePoint", "[2, 0], [2, 3]", "[2, 0], [2, .inf]", "must be a finite number"},
        BadPlan{"WordForNumber", "[2, 0], [2, 3]", "[two, 0], [2, 3]", "must be a number"},
        BadPlan{"ThreeCoordinates", "[2, 0], [2, 3]", "[2, 0, 1], [2, 3]", "[x, y]"},
        BadPlan{"WallOutside", "[2, 0], [2, 3]", "[2, 0], [2, 30]", "outside the drawing"},
        BadPlan{"WallOfOnePoint", "[2, 0], [2, 3]", "[2, 0]", "at least 2 points"},
        BadPlan{"WallOfNoLength", "[2, 0], [2, 3]", "[2, 0], [2, 0]", "is repeated"},
        BadPlan{"NegativeThickness", "wall_thickness: 0.2", "wall_thickness: -0.2",
                "must be within"},
        BadPlan{"NegativeDoorWidth", "width: 1.0", "width: -1.0", "doors[0].width"},
        BadPlan{"DoorNotOnAWall", "at: [2, 1.5]", "at: [1, 1.5]", "not on the centre line"},
        BadPlan{"DoorTooWide", "width: 1.0", "width: 3.5", "does not fit"},
        BadPlan{"DoorInACorner", "at: [2, 1.5]", "at: [2, 0.1]", "does not fit"},
        BadPlan{"DoorCrossedByAWall", "  - {name: middle,",
                "  - {name: across, points: [[1, 1.7], [3, 1.7]]}\n  - {name: middle,",
                "crossed by wall 'across'"},
        BadPlan{"WrongSwing", "swing: left", "swing: lef", "did you mean 'left'?"},
        BadPlan{"ScheduleGoingBack", "from: 20", "from: 5", "must increase"},
        BadPlan{"ScheduleWithoutState", "{from: 20, open: true}", "{from: 20}", "open"},
        BadPlan{"OpenIsNoTruthValue", "from: 20, open: true", "from: 20, open: 3", "true or false"},
        BadPlan{"ConfigurationOfNoDoor",
                "furniture:", "configurations:\n  - {name: open, open: [dor]}\nfurniture:",
                "did you mean 'door'?"},
        BadPlan{"ConfigurationTwice", "furniture:",
                "configurations:\n  - {name: shut, open: []}\n  - {name: shut}\nfurniture:",
                "used twice"},
        BadPlan{"AreaOfAnUnknownKind",
                "furniture:", "areas:\n  - {kind: corrner, box: [1, 1, 1, 1]}\nfurniture:",
                "did you mean 'corner'?"},
        BadPlan{"AreaWithoutKind",
                "furniture:", "areas:\n  - {box: [1, 1, 1, 1]}\nfurniture:", "areas[0].kind"},
        BadPlan{"AreaWithoutShape",
                "furniture:", "areas:\n  - {kind: hall}\nfurniture:", "exactly one"},
        BadPlan{"AreaOutside", "furniture:",
                "areas:\n  - {kind: hall, box: [1, 1, 100, 1]}\nfurniture:", "outside the drawing"},
        BadPlan{"FloorOfAnUnknownKind",
                "furniture:", "floor_kind: corridr\nfurniture:", "did you mean 'corridor'?"},
        BadPlan{"NegativeFurniture", "0.4, 0.2]", "0.4, -0.2]", "must be positive"},
        BadPlan{"FurnitureWithoutShape", "box: [3, 2.5, 0.4, 0.2]", "height: 1", "exactly one"},
        BadPlan{"PlaceInAWall", "at: [1, 1]}", "at: [2, 0.5]}", "inside wall 'middle'"},
        BadPlan{"PlaceOutside", "at: [1, 1]}", "at: [1, 10]}", "outside the drawing"},
        BadPlan{"PlaceWithoutName", "name: left", "name: ''", "non-empty"},
        BadPlan{"PlaceTwice", "- {name: left, at: [1, 1]}",
                "- {name: left, at: [1, 1]}\n  - {name: left, at: [1, 2]}", "used twice"},
        BadPlan{"PlaceBesideItsPolygon", "at: [1, 1]}",
                "at: [1, 1], polygon: [[1.5, 1.5], [1.8, 1.5], [1.8, 1.8]]}", "does not contain"},
        BadPlan{"InteriorLeaks", "closed: true, ", "", "not closed"},
        BadPlan{"NoInterior", "places:\n  - {name: left, at: [1, 1]}\n", "",
                "tells where the interior is"},
        BadPlan{"WallsAreNoList", "walls:\n", "walls: 3\ninside:\n", "must be a list"}),
    [](const testing::TestParamInfo<BadPlan>& tested) { return std::string(tested.param.name); });

void expectRefused(const std::function<void()>& action, const std::string& part) {
  try {
    action();
    FAIL() << "was accepted";
  } catch (const hyselam::InputError& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST(BadPlanFile, Empty) {
  expectRefused([] { parseFloorPlan("", "x.yaml"); }, "x.yaml: the file is empty");
}
TEST(BadPlanFile, IsAList) {
  expectRefused([] { parseFloorPlan("[1, 2]", "x.yaml"); }, "mapping");
}
TEST(BadPlanFile, Missing) {
  expectRefused([] { loadFloorPlan("/nowhere/x.yaml"); }, "/nowhere/x.yaml");
}
TEST(BadPlanFile, UnknownPlaceSuggestsTheNearest) {
  const FloorPlan plan = parseFloorPlan(kRoom, "room.yaml");
  expectRefused([&] { plan.place("letf"); }, "did you mean 'left'?");
}
TEST(BadPlanFile, UnknownConfigurationSuggestsTheNearest) {
  FloorPlan plan = loadFloorPlan(planFile("university"));
  expectRefused([&] { plan.setDoors("E_C9"); }, "no configuration of doors 'E_C9'");
}
TEST(BadPlanFile, UnknownShippedNameSuggestsTheNearest) {
  expectRefused([] { planFile("mcl_d"); }, "did you mean 'mcl_a'?");
  expectRefused([] { routeFile("offise"); }, "did you mean 'office'?");
}
TEST(BadPlanFile, DeeplyNestedYaml) {
  expectRefused([] { parseFloorPlan(std::string(100000, '['), "x.yaml"); }, "nested too deep");
  std::string dashes;
  for (int i = 0; i < 50000; ++i) dashes += "- ";
  expectRefused([&] { parseFloorPlan(dashes + "1", "x.yaml"); }, "nested too deep");
}

}  // namespace
}  // namespace hyselam_sim

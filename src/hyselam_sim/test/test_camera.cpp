// What the camera sees: depths as rays measure them, light by the hour, people, doors, truth.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/camera.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/film.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/plan_ray_caster.hpp"
#include "hyselam_sim/things.hpp"

namespace hyselam_sim {
namespace {

FloorPlan twoRooms() {
  return parseFloorPlan(R"(
plan: two rooms
origin: [-1, -1]
size: [12, 7]
walls:
  - {name: outer, closed: true, points: [[0, 0], [10, 0], [10, 5], [0, 5]]}
  - {name: middle, points: [[5, 0], [5, 5]]}
doors:
  - {name: door, at: [5, 2.5], width: 1.0, schedule: [{from: 10, open: false}]}
furniture:
  - {name: crate, box: [8, 2.5, 1, 1], height: 0.5}
places:
  - {name: west, at: [2, 2.5]}
  - {name: east, at: [7, 1]}
)",
                        "two rooms");
}

CameraFrame look(const Scene& scene, const Pose2& base, double time = 0.0,
                 const LightParams& light = {}, const std::vector<Person>& people = {},
                 const CameraParams& params = {}) {
  hyselam::Rng rng(1);
  return takePicture(params, scene, light, people, base, time, rng);
}

double brightness(const CameraFrame& frame) {
  const cv::Scalar mean = cv::mean(frame.color);
  return (mean[0] + mean[1] + mean[2]) / 3.0;
}

// Walls reach from floor to ceiling: at eye level the nearest surface is what the plan's edges
// give, unless something hangs on the wall (2 cm, windows' frames 6 cm).
TEST(Camera, MeasuresTheDepthsThatRaysMeasure) {
  const FloorPlan plan = loadFloorPlan(planFile("office"));
  const Scene scene(plan);
  CameraParams params;
  params.depth_sigma = 0.0;
  params.depth_min = 0.0;
  params.above_floor = 2.3;  // above furniture and open doors
  FloorPlan bare = plan;
  bare.furniture.clear();
  const PlanRayCaster walls(edges(wallSolids(bare)));
  hyselam::Rng rng(7);
  std::size_t compared = 0;
  for (int i = 0; i < 20; ++i) {
    const PlanPlace& place = plan.places[rng.below(static_cast<std::uint32_t>(plan.places.size()))];
    const Pose2 base{place.at.x, place.at.y, rng.uniform(-3.0, 3.0)};
    const CameraFrame frame = look(scene, base, 0.0, {}, {}, params);
    const Pose2 eye = base * params.camera_in_base;
    for (int u = 0; u < params.width; u += 7) {
      const double x = (u + 0.5 - 0.5 * params.width) / params.focalLength();
      const Point2 ray{std::cos(eye.theta) + x * std::sin(eye.theta),
                       std::sin(eye.theta) - x * std::cos(eye.theta)};
      const double scale = length(ray);
      const double range = walls.cast({eye.x, eye.y}, (1.0 / scale) * ray, 50.0) / scale;
      // Lintels close the doorways at this height.
      const double depth = 0.001 * frame.depth.at<std::uint16_t>(params.height / 2, u);
      if (depth == 0.0) {
        EXPECT_GE(range, params.depth_max - 0.1);
        continue;
      }
      EXPECT_LE(depth, range + 0.002) << "pose " << i << ", column " << u;
      if (depth > range - 0.15) ++compared;
    }
  }
  EXPECT_GT(compared, 1000u);
}

TEST(Camera, SeesTheFloorWhereItIs) {
  const Scene scene(twoRooms());
  CameraParams params;
  params.depth_sigma = 0.0;
  const CameraFrame frame = look(scene, {1.0, 0.5, hyselam::kPi / 2}, 0.0, {}, {}, params);
  // The floor in the last row: depth = f h / (row - middle).
  const double expected = params.focalLength() * params.above_floor / (0.5 * params.height - 0.5);
  EXPECT_NEAR(0.001 * frame.depth.at<std::uint16_t>(params.height - 1, params.width / 2), expected,
              0.002);
}

TEST(Camera, TellsWhoAPixelBelongsTo) {
  const Scene scene(twoRooms());
  const CameraFrame frame = look(scene, {6.0, 2.5, 0.0});
  const int middle = frame.owner.cols / 2;
  EXPECT_EQ(frame.owner.at<std::int32_t>(10, middle), 0);
  const int crate = frame.owner.at<std::int32_t>(frame.owner.rows - 60, middle);
  EXPECT_EQ(scene.ownerName(static_cast<std::uint32_t>(crate)), "crate");
  EXPECT_EQ(scene.ownerName(0), "");
  EXPECT_EQ(scene.ownerName(99), "");
}

TEST(Camera, ThingsStandWhereTheyArePut) {
  SceneParams params;
  Thing cup;
  cup.name = "cup";
  cup.shape = Thing::Shape::kCylinder;
  cup.pose = {7.7, 2.5, 0.0};
  cup.z = 0.5;
  cup.size = {0.08, 0.08, 0.1};
  params.things.push_back(cup);
  const Scene scene(twoRooms(), params);
  const CameraFrame frame = look(scene, {6.0, 2.5, 0.0});
  cv::Mat mask = frame.owner == 2;
  EXPECT_EQ(scene.ownerName(2), "cup");
  ASSERT_GT(cv::countNonZero(mask), 50);
  const double depth = cv::mean(frame.depth, mask)[0] * 0.001;
  EXPECT_NEAR(depth, 7.7 - 6.15, 0.05);
}

TEST(Things, AreReadFromAFile) {
  const auto things = parseThings(R"(things:
  - {name: cup 1, kind: cup, shape: cylinder, at: [1, 2], above_floor: 0.7, size: [0.1, 0.1, 0.12]}
  - {name: PC, at: [3, 4], turn: 90, colour: [0, 0.5, 1]}
)",
                                  "things.yaml");
  ASSERT_EQ(things.size(), 2u);
  EXPECT_EQ(things[0].kind, "cup");
  EXPECT_EQ(things[0].shape, Thing::Shape::kCylinder);
  EXPECT_EQ(things[0].z, 0.7);
  EXPECT_EQ(things[0].size[2], 0.12);
  EXPECT_EQ(things[1].kind, "PC");
  EXPECT_EQ(things[1].shape, Thing::Shape::kBox);
  EXPECT_NEAR(things[1].pose.theta, 0.5 * M_PI, 1e-12);
  EXPECT_EQ(things[1].color[1], 0.5f);
}

TEST(Things, RefusesWhatCannotBe) {
  for (const auto& [text, reason] :
       {std::pair<const char*, const char*>{"things: [{at: [1, 2]}]", "name"},
        {"things: [{name: a}]", "at"},
        {"things: [{name: a, at: [1, 2], size: [0, 1, 1]}]", "size"},
        {"things: [{name: a, at: [1, 2], size: [1, 1]}]", "three numbers"},
        {"things: [{name: a, at: [1, 2], colour: [0, 0, 2]}]", "colour"},
        {"things: [{name: a, at: [1, .nan]}]", "at"},
        {"things: [{name: a, at: [1, 2], shape: ball}]", "shape"},
        {"things: [{name: a, at: [1, 2], hue: 1}]", "hue"},
        {"things: [{name: a, at: [1, 2]}, {name: a, at: [3, 2]}]", "given before"},
        {"things: {", "things.yaml"},
        {"[]", "things.yaml"}}) {
    try {
      parseThings(text, "things.yaml");
      FAIL() << text;
    } catch (const hyselam::InputError& e) {
      EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find("things.yaml"), 0u) << e.what();
    }
  }
  EXPECT_THROW(loadThings("none.yaml"), hyselam::InputError);
}

TEST(Camera, DoorsShutByTheClock) {
  const Scene scene(twoRooms());
  const auto depth_at = [&](double time) {
    return look(scene, {2.0, 2.5, 0.0}, time).depth.at<std::uint16_t>(240, 320) * 0.001;
  };
  EXPECT_GT(depth_at(0.0), 5.0);
  EXPECT_NEAR(depth_at(11.0), 5.0 - kLeafThickness / 2 - 2.15, 0.03);
}

TEST(Camera, PeopleStandInTheWay) {
  const Scene scene(twoRooms());
  Person person;
  person.name = "anna";
  person.points = {{4.0, 2.5}, {4.0, 4.0}};
  person.start_time = 100.0;
  const CameraFrame frame = look(scene, {1.0, 2.5, 0.0}, 0.0, {}, {person});
  EXPECT_NEAR(frame.depth.at<std::uint16_t>(230, 320) * 0.001, 4.0 - 0.9 * 0.25 - 1.15, 0.05);
}

TEST(Camera, NightIsDarkUntilTheLampsAreOn) {
  const Scene scene(twoRooms());
  LightParams night;
  night.hour = 23.0;
  night.lamps = LightParams::Lamps::kOff;
  LightParams lamps = night;
  lamps.lamps = LightParams::Lamps::kByHour;
  CameraParams params;
  params.exposure = 0.0;  // the light itself
  const Pose2 base{2.0, 2.5, 1.0};
  const double dark = brightness(look(scene, base, 0.0, night, {}, params));
  EXPECT_LT(dark, 0.4 * brightness(look(scene, base, 0.0, lamps, {}, params)));
  EXPECT_LT(dark, 0.4 * brightness(look(scene, base, 0.0, {}, {}, params)));
}

TEST(Camera, ExposureEvensOutTheHours) {
  const Scene scene(loadFloorPlan(planFile("office")));
  for (const double hour : {8.5, 12.0, 16.0, 18.0, 22.0}) {
    LightParams light;
    light.hour = hour;
    const double b = brightness(look(scene, {2.0, 11.0, 1.6}, 0.0, light));
    EXPECT_GT(b, 60.0) << hour;
    EXPECT_LT(b, 200.0) << hour;
  }
}

TEST(Camera, RoomsLookDifferentAndOneSeedLooksTheSame) {
  const Scene a(loadFloorPlan(planFile("office"))), b(loadFloorPlan(planFile("office")));
  SceneParams other;
  other.seed = 2;
  const Scene c(loadFloorPlan(planFile("office")), other);
  const auto same = [](const CameraFrame& x, const CameraFrame& y) {
    return cv::norm(x.color, y.color, cv::NORM_INF) == 0.0 &&
           cv::norm(x.depth, y.depth, cv::NORM_INF) == 0.0;
  };
  const Pose2 base{2.0, 11.0, 1.6};
  EXPECT_TRUE(same(look(a, base), look(b, base)));
  EXPECT_FALSE(same(look(a, base), look(c, base)));
  EXPECT_GT(cv::norm(look(a, {2.0, 11.0, 1.6}).color, look(a, {6.0, 11.0, 1.6}).color, cv::NORM_L1),
            5.0 * 640 * 480);
}

TEST(Camera, RefusesParametersOutOfRange) {
  const Scene scene(twoRooms());
  const auto refused = [&](auto change) {
    CameraParams params;
    change(params);
    EXPECT_THROW(look(scene, {2.0, 2.5, 0.0}, 0.0, {}, {}, params), hyselam::ParameterError);
  };
  refused([](CameraParams& p) { p.width = 0; });
  refused([](CameraParams& p) { p.height = 100000; });
  refused([](CameraParams& p) { p.view = 0.0; });
  refused([](CameraParams& p) { p.above_floor = -1.0; });
  refused([](CameraParams& p) { p.depth_max = 0.1; });
  refused([](CameraParams& p) { p.noise = std::nan(""); });
  SceneParams look_params;
  look_params.poster_share = 1.5;
  EXPECT_THROW(Scene(twoRooms(), look_params), hyselam::ParameterError);
}

TEST(FloorRegions, TellsRoomAndPlace) {
  const FloorPlan plan = loadFloorPlan(planFile("office"));
  const FloorRegions regions(plan);
  for (std::size_t i = 0; i < plan.places.size(); ++i) {
    EXPECT_EQ(regions.placeAt(plan.places[i].at), static_cast<int>(i)) << plan.places[i].name;
    EXPECT_TRUE(regions.onFloor(plan.places[i].at));
  }
  const auto room = [&](const char* name) { return regions.roomAt(plan.place(name).at); };
  EXPECT_EQ(room("west corridor"), room("middle of the corridor"));
  EXPECT_NE(room("kitchen"), room("library"));
  EXPECT_FALSE(regions.onFloor({5.0, 3.0}));  // in a wall
  EXPECT_EQ(regions.placeAt({-50.0, 0.0}), -1);
}

TEST(Film, TakesThePicturesOfTheRunWithTheirTruth) {
  const Scene scene(twoRooms());
  hyselam::RobotLog log;
  for (int i = 0; i <= 40; ++i) {
    log.ground_truth.push_back({1.0 + 0.05 * i, {3.9 + 0.05 * i, 2.5, 0.0}});
  }
  FilmParams params;
  params.rate = 5.0;
  params.camera.width = 64;
  params.camera.height = 48;
  std::vector<FilmFrame> frames;
  film(scene, log, {}, 1, params, [&](const FilmFrame& frame) { frames.push_back(frame); });
  ASSERT_EQ(frames.size(), filmLength(log, params));
  ASSERT_EQ(frames.size(), 11u);
  EXPECT_EQ(frames.front().place, 0);
  EXPECT_EQ(frames.back().place, 1);
  EXPECT_NEAR(frames[5].base.x, 4.9, 1e-9);
  EXPECT_NEAR(frames[5].stamp, 2.0, 1e-9);
  EXPECT_THROW(film(scene, {}, {}, 1, params, [](const FilmFrame&) {}), hyselam::InputError);
}

TEST(Film, DoesNotFlyBetweenTheEndsOfAJump) {
  const Scene scene(twoRooms());
  hyselam::RobotLog log;
  log.ground_truth = {{1.0, {2.0, 2.5, 0.0}}, {2.0, {8.0, 1.0, 0.0}}};
  FilmParams params;
  params.rate = 2.0;
  params.camera.width = 64;
  params.camera.height = 48;
  std::vector<double> x;
  film(scene, log, {}, 1, params, [&](const FilmFrame& frame) { x.push_back(frame.base.x); });
  EXPECT_EQ(x, (std::vector<double>{2.0, 2.0, 8.0}));
}

}  // namespace
}  // namespace hyselam_sim

// Drawn tables with boxes and cylinders, as a Kinect sees them: scenes in which nothing real is.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "hyselam_objects/segmentation/organized_cloud.hpp"
#include "hyselam_sim/camera.hpp"

namespace hyselam_objects {

/// 640x480, focal length 525. Four to nine things of 5 to 25 cm, apart from each other; every
/// second scene has a box of a milk carton's size.
inline OrganizedCloud drawTable(std::uint64_t seed) {
  using hyselam_sim::Thing;
  constexpr double kFocal = 525.0, kApart = 0.19;
  hyselam::Rng rng(seed);
  hyselam_sim::SceneParams look;
  std::vector<hyselam::Point2> taken;
  const int count = 4 + static_cast<int>(rng.below(6));
  for (int i = 0; i < count; ++i) {
    Thing thing;
    thing.name = "thing " + std::to_string(i);
    thing.shape = rng.below(2) == 0 ? Thing::Shape::kBox : Thing::Shape::kCylinder;
    thing.size = {rng.uniform(0.05, 0.16), rng.uniform(0.05, 0.16), rng.uniform(0.05, 0.25)};
    if (i == 0 && seed % 2 == 0) {
      thing.shape = Thing::Shape::kBox;
      thing.size = {0.09, 0.06, 0.19};
    }
    if (thing.shape == Thing::Shape::kCylinder) thing.size[1] = thing.size[0];
    const hyselam::Point2 at{rng.uniform(1.4, 1.9), rng.uniform(2.6, 3.4)};
    const bool free = std::none_of(taken.begin(), taken.end(), [&](const hyselam::Point2& other) {
      return std::hypot(at.x - other.x, at.y - other.y) < kApart;
    });
    const double turn = rng.uniform(0.0, hyselam::kPi);
    if (!free) continue;
    taken.push_back(at);
    thing.pose = {at.x, at.y, turn};
    thing.z = 0.5;
    look.things.push_back(thing);
  }
  const hyselam_sim::Scene scene(hyselam_sim::parseFloorPlan(R"(
plan: table
origin: [-1, -1]
size: [8, 8]
walls: [{points: [[0, 0], [6, 0], [6, 6], [0, 6]], closed: true}]
furniture: [{name: plateau, box: [1.7, 3, 1.2, 1.8], height: 0.5}]
places: [{name: room, at: [1, 1]}]
)",
                                                             "table"),
                                 look);
  hyselam_sim::CameraParams camera;
  camera.above_floor = 1.0;
  camera.view = 2.0 * std::atan(320.0 / kFocal);
  const hyselam_sim::CameraFrame frame =
      hyselam_sim::takePicture(camera, scene, {}, {}, {0.45, 3.0, 0.0}, 0.0, rng);
  OrganizedCloud cloud;
  cloud.width = camera.width;
  cloud.height = camera.height;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const float z = 0.001f * frame.depth.at<std::uint16_t>(v, u);
      if (!(z > 0.0f)) {
        cloud.points.emplace_back(nan, nan, nan);
        continue;
      }
      cloud.points.emplace_back((static_cast<float>(u) - 319.5f) * z / static_cast<float>(kFocal),
                                (static_cast<float>(v) - 239.5f) * z / static_cast<float>(kFocal),
                                z);
    }
  }
  return cloud;
}

}  // namespace hyselam_objects

// ObjectDetector (dos Santos, section 3.2.4): furniture and the things on it and on the floor, in
// one frame of a colour and depth camera whose pose is known.
//
// Level surfaces above the floor are furniture; what stands on them or on the floor is split as in
// segment_cloud.hpp. What is taller than `tallest` without a level top is taken for a wall.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "hyselam_objects/object_map.hpp"
#include "hyselam_objects/segment_cloud.hpp"

namespace hyselam_objects {

struct DetectParams {
  SegmentParams segment;          ///< `support_distance` and `tallest` hold above furniture
  double range = 4.0;             ///< what is farther is not looked at [m], > 0
  double level = 0.35;            ///< normals of level surfaces differ by less from upright [rad]
  double surface_area = 0.15;     ///< of furniture [m^2], > 0
  double surface_height = 0.2;    ///< lower ones are no furniture [m], > 0
  double tallest = 1.2;           ///< thing on the floor [m], > 0
  double floor_clearance = 0.03;  ///< what is lower is floor [m], > 0
  int smallest = 30;              ///< points of a thing, >= 10
};

/// One thing in one frame. Boxes have the directions of the map's axes.
struct DetectedObject {
  bool furniture = false;  ///< it has a level top
  /// By the border of the frame, or its foot is hidden (nothing seen carries it): it may be larger.
  bool cut = false;
  Point3 low, high;  ///< corners of the box around it, map frame
  std::vector<float> descriptor;
  std::string colour;
  std::size_t points = 0;

  Point3 center() const {
    return {0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};
  }
};

/// Throws as segmentCloud(); hyselam::InputError for a pose that is not finite.
std::vector<DetectedObject> detectObjects(const OrganisedCloud& cloud,
                                          const Eigen::Isometry3d& camera_in_map,
                                          const DetectParams& params = {});

}  // namespace hyselam_objects

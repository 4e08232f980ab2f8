// ObjectDetector (dos Santos, section 3.2.4), first half: furniture, and the objects on it and on
// the floor, in one frame of a color and depth camera whose pose is known.
//
// Horizontal surfaces above the floor are furniture; what stands on them or on the floor is split
// into the patches of segment_cloud.hpp, which are joined by fixed rules. What is taller than
// `max_object_height` and has no horizontal top is taken for a wall.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"

namespace hyselam_objects {

struct DetectParams {
  SegmentParams segmentation;  ///< its `support_distance` and `max_object_height` hold on furniture
  double max_range = 4.0;      ///< farther points are ignored [m], > 0
  double max_tilt = 0.35;      ///< of normals of a horizontal surface from upright [rad], 0 .. 1.5
  double min_surface_area = 0.15;   ///< of the top of a piece of furniture [m^2], > 0
  double min_surface_height = 0.2;  ///< of that top above the floor [m], > 0
  double max_object_height = 1.2;   ///< of an object that stands on the floor [m], > 0
  double floor_clearance = 0.03;    ///< lower points belong to the floor [m], > 0
  int min_points = 30;              ///< of an object, >= 10

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// One object in one frame.
struct DetectedObject {
  bool furniture = false;  ///< it has a horizontal top
  /// Cut by the border of the frame, or its lower part is hidden (nothing seen carries it): it may
  /// be larger.
  bool partial = false;
  /// Lower and upper corner of the box around it that is aligned with the axes of the map [m].
  Point3 low, high;
  Outline outline;                ///< empty: that of this box
  std::vector<float> descriptor;  ///< as describeView()
  std::string color;              ///< as colorName()
  std::size_t points = 0;         ///< number of points

  Point3 center() const {
    return {0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z)};
  }
  /// Of the box around it, turned as it is [m].
  Eigen::Vector3d size() const;
};

/// @throws hyselam::InputError as checkCloud(), and for a pose that is not finite;
///         hyselam::ParameterError.
std::vector<DetectedObject> detectObjects(const OrganizedCloud& cloud,
                                          const Eigen::Isometry3d& camera_in_map,
                                          const DetectParams& params = {});

}  // namespace hyselam_objects

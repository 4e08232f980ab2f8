// What a depth camera saw, and where it was.
#pragma once

#include <Eigen/Geometry>

#include "hyselam_objects/segmentation/organized_cloud.hpp"

namespace hyselam_objects {

struct PlacedView {
  OrganizedCloud cloud;  ///< in the camera's optical frame
  /// That frame in one that all views have in common [m].
  Eigen::Isometry3f camera = Eigen::Isometry3f::Identity();
};

}  // namespace hyselam_objects

// Segmentation of clouds without rows and columns: merged views, laser scanners, models.
#pragma once

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"

namespace hyselam_objects {

struct UnorganizedParams {
  double voxel_size = 0.005;        ///< of the voxel grid filter [m], > 0
  double support_distance = 0.012;  ///< nearer points belong to the support plane [m], > 0
  double cluster_gap = 0.015;       ///< points nearer than this belong together [m], > 0
  double max_object_height = 0.6;   ///< above the support plane [m], > 0
  int min_points = 60;              ///< of a filtered object, >= 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Support plane and clusters above it, for points in any order. The position of the `sensor`
/// tells which side of the plane is free. Objects that touch come out as one: only organized clouds
/// are split at concave edges.
/// @throws hyselam::InputError as checkCloud(); hyselam::ParameterError.
CloudSegmentation segmentUnorganized(const OrganizedCloud& cloud, const Eigen::Vector3f& sensor,
                                     const UnorganizedParams& params = {});

}  // namespace hyselam_objects

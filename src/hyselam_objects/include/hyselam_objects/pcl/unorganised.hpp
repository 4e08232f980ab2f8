// Clouds without rows and columns: merged views, laser scanners, models.
#pragma once

#include "hyselam_objects/segment_cloud.hpp"

namespace hyselam_objects {

struct UnorganisedParams {
  double voxel = 0.005;             ///< side of the cells that points are thinned to [m], > 0
  double support_distance = 0.012;  ///< what is nearer to the support belongs to it [m], > 0
  double gap = 0.015;               ///< points nearer than this belong together [m], > 0
  double tallest = 0.6;             ///< above the support [m], > 0
  int smallest = 60;                ///< points of a thinned object, >= 1
};

/// Support plane and clusters above it, for points in any order; `up` tells the side that is free
/// (towards the sensor). Objects that touch come out as one: only organised clouds are split at
/// concave edges. Throws as segmentCloud().
Segmentation segmentUnorganised(const OrganisedCloud& cloud, const Eigen::Vector3f& sensor,
                                const UnorganisedParams& params = {});

}  // namespace hyselam_objects

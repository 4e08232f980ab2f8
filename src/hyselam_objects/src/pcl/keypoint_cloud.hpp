// Points of a surface that are worth comparing, each with what is around it (SHOT, Salti et al.
// 2014).
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "hyselam_objects/pcl/find_model.hpp"

namespace hyselam_objects {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

struct KeypointCloud {
  Cloud::Ptr all, keypoints;
  pcl::PointCloud<pcl::Normal>::Ptr normals;       ///< of all; empty for a model of several views
  pcl::PointCloud<pcl::SHOT352>::Ptr descriptors;  ///< of the keypoints
};

/// The keypoints of all views of a model, each described by what its camera saw: normals point to
/// where it was, and of a thin part there is the near side only, as in a scene.
/// @throws hyselam::InputError for fewer than 100 usable points.
KeypointCloud describeModel(const SurfaceModel& model, const FindModelParams& params);

/// Those of a scene seen from its origin, without the ones that have far fewer points around them
/// than those of the model. @throws hyselam::InputError as above.
KeypointCloud describeScene(const OrganizedCloud& scene, const KeypointCloud& model,
                            const FindModelParams& params);

/// What stands on a level surface, if there is one; else all of the scene. A table has most of the
/// points, and looks like any plane.
OrganizedCloud thingsOf(const OrganizedCloud& scene);

}  // namespace hyselam_objects

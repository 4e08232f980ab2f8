// A model, as a cloud, found in a scene: SHOT descriptors, correspondences that agree on a pose
// (Chen and Bhanu 2007, as in PCL), refined by ICP, and how much of it is there.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hyselam_objects/organised_cloud.hpp"

namespace hyselam_objects {

struct FindModelParams {
  double model_sampling = 0.01;     ///< keypoints are that far apart [m], > 0
  double scene_sampling = 0.02;     ///< [m], > 0
  double descriptor_radius = 0.03;  ///< [m], > 0
  double consistency = 0.01;  ///< two correspondences agree if their lengths differ by less [m]
  int least = 5;              ///< correspondences of a pose, >= 3
  int candidates = 3;         ///< poses with most correspondences that are refined, >= 1
  double touch = 0.01;        ///< a point of the model lies on the scene within this [m]
};

struct FoundModel {
  Eigen::Isometry3d model_in_scene = Eigen::Isometry3d::Identity();
  std::size_t correspondences = 0;
  double covered = 0.0;  ///< share of the model's points that lie on the scene, 0 .. 1
};

/// The poses refined, the one that covers most first. Throws hyselam::InputError for clouds without
/// 100 usable points, hyselam::ParameterError for parameters out of range.
std::vector<FoundModel> findModel(const OrganisedCloud& model, const OrganisedCloud& scene,
                                  const FindModelParams& params = {});

}  // namespace hyselam_objects

// A model, given as a cloud, found in a scene: SHOT descriptors, correspondences that agree on a
// pose (Chen and Bhanu 2007, as in PCL), refined by ICP, and judged by what the camera could see:
// how much of the visible part is covered, what it looks through, and whether the scene goes on
// beyond the outline.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/segmentation/learn_model.hpp"
#include "hyselam_objects/segmentation/placed_view.hpp"

namespace hyselam_objects {

struct FindModelParams {
  double surface_sampling = 0.004;     ///< distance of points that are looked at [m], > 0
  double model_sampling = 0.01;        ///< distance of keypoints in the model [m], > 0
  double scene_sampling = 0.02;        ///< ... and in the scene [m], > 0
  double descriptor_radius = 0.03;     ///< [m], > 0
  double consistency_distance = 0.01;  ///< by which lengths of two correspondences may differ [m]
  int min_correspondences = 5;         ///< of a pose, >= 3
  int max_hypotheses = 8;              ///< poses with most correspondences that are refined, >= 1
  double inlier_distance = 0.01;       ///< of a point of the model to the scene [m], > 0
  double min_probability = 0.5;        ///< of a pose that is told, 0 .. 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct FoundModel {
  Eigen::Isometry3d model_in_scene = Eigen::Isometry3d::Identity();
  std::size_t correspondences = 0;
  double coverage = 0.0;     ///< share of the model's visible points that lie on the scene, 0 .. 1;
                             ///< the camera looks through the others
  double visible = 0.0;      ///< share of the points on its near side that nothing hides, 0 .. 1
  double probability = 0.0;  ///< that it is there, 0 .. 1
  double flush = 0.0;        ///< share of its outline at which the scene goes on as it does, 0 .. 1
  int looks = 1;             ///< of a scene of several views, those in which it was suggested
};

/// The likely poses, the best first; none where the model is not there, one for each part of the
/// scene that it explains. Of a model of several views each is described as its camera saw it: a
/// scene shows one side of things. A scene that is not one view from its origin tells nothing of
/// free space.
/// @throws hyselam::InputError for clouds with fewer than 100 usable points;
///         hyselam::ParameterError.
std::vector<FoundModel> findModel(const SurfaceModel& model, const OrganizedCloud& scene,
                                  const FindModelParams& params = {});
/// A scene seen from several sides: what one of them suggests is judged by what all could see;
/// poses are in the frame that the views have in common. @throws hyselam::InputError also for no
/// view, and for one of several that is no view from its origin.
std::vector<FoundModel> findModel(const SurfaceModel& model, const std::vector<PlacedView>& scene,
                                  const FindModelParams& params = {});
/// A model that was seen from its origin.
std::vector<FoundModel> findModel(const OrganizedCloud& model, const OrganizedCloud& scene,
                                  const FindModelParams& params = {});

}  // namespace hyselam_objects

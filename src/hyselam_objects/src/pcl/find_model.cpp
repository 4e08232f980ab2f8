#include "hyselam_objects/pcl/find_model.hpp"

#include <pcl/common/transforms.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/shot.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/recognition/cg/geometric_consistency.h>
#include <pcl/registration/icp.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Shots = pcl::PointCloud<pcl::SHOT352>;

Cloud::Ptr toPcl(const OrganizedCloud& cloud, const char* name) {
  Cloud::Ptr out(new Cloud);
  for (const Point& p : cloud.points) {
    if (p.allFinite()) out->push_back({p.x(), p.y(), p.z()});
  }
  if (out->size() < 100) throw hyselam::InputError(name, "", "has fewer than 100 usable points");
  return out;
}

struct KeypointCloud {
  Cloud::Ptr all, keypoints;
  Shots::Ptr descriptors;  ///< of the keypoints
};

KeypointCloud describeKeypoints(const OrganizedCloud& cloud, const char* name, double sampling,
                                double radius) {
  KeypointCloud out;
  out.all = toPcl(cloud, name);
  Normals::Ptr normals(new Normals);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimate;
  estimate.setKSearch(10);
  estimate.setInputCloud(out.all);
  estimate.compute(*normals);
  out.keypoints.reset(new Cloud);
  pcl::UniformSampling<pcl::PointXYZ> sample;
  sample.setInputCloud(out.all);
  sample.setRadiusSearch(sampling);
  sample.filter(*out.keypoints);
  out.descriptors.reset(new Shots);
  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> shot;
  shot.setRadiusSearch(radius);
  shot.setInputCloud(out.keypoints);
  shot.setInputNormals(normals);
  shot.setSearchSurface(out.all);
  shot.compute(*out.descriptors);
  return out;
}

/// Pairs of a keypoint of the model and one of the scene with similar descriptors.
pcl::CorrespondencesPtr matchDescriptors(const KeypointCloud& model, const KeypointCloud& scene) {
  constexpr float kMaxSquaredDistance = 0.25f;  // of SHOT descriptors, as in PCL's tutorial
  pcl::KdTreeFLANN<pcl::SHOT352> nearest;
  nearest.setInputCloud(model.descriptors);
  pcl::CorrespondencesPtr pairs(new pcl::Correspondences);
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (std::size_t i = 0; i < scene.descriptors->size(); ++i) {
    const pcl::SHOT352& shot = (*scene.descriptors)[i];
    if (!std::isfinite(shot.descriptor[0])) continue;
    if (nearest.nearestKSearch(shot, 1, index, squared) == 1 && squared[0] < kMaxSquaredDistance) {
      pairs->emplace_back(index[0], static_cast<int>(i), squared[0]);
    }
  }
  return pairs;
}

struct PoseHypothesis {
  Eigen::Matrix4f model_in_scene;
  std::size_t correspondences = 0;
};

/// Poses that many correspondences agree on, those with most first, at most `max_hypotheses`.
std::vector<PoseHypothesis> groupCorrespondences(const KeypointCloud& model,
                                                 const KeypointCloud& scene,
                                                 const FindModelParams& params) {
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> poses;
  std::vector<pcl::Correspondences> groups;
  pcl::GeometricConsistencyGrouping<pcl::PointXYZ, pcl::PointXYZ> grouping;
  grouping.setGCSize(params.consistency_distance);
  grouping.setGCThreshold(params.min_correspondences);
  grouping.setInputCloud(model.keypoints);
  grouping.setSceneCloud(scene.keypoints);
  grouping.setModelSceneCorrespondences(matchDescriptors(model, scene));
  grouping.recognize(poses, groups);
  std::vector<PoseHypothesis> hypotheses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    hypotheses.push_back({poses[i], groups[i].size()});
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) {
                     return a.correspondences > b.correspondences;
                   });
  hypotheses.resize(std::min(hypotheses.size(), static_cast<std::size_t>(params.max_hypotheses)));
  return hypotheses;
}

/// Refines a hypothesis by ICP and measures the coverage of the model.
FoundModel refine(const PoseHypothesis& hypothesis, const KeypointCloud& model,
                  const KeypointCloud& scene, const pcl::KdTreeFLANN<pcl::PointXYZ>& scene_tree,
                  double inlier_distance) {
  constexpr int kIterations = 20;
  constexpr double kMaxCorrespondence = 0.02;  // [m]
  Cloud::Ptr placed(new Cloud), refined(new Cloud);
  pcl::transformPointCloud(*model.keypoints, *placed, hypothesis.model_in_scene);
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setMaximumIterations(kIterations);
  icp.setMaxCorrespondenceDistance(kMaxCorrespondence);
  icp.setInputSource(placed);
  icp.setInputTarget(scene.all);
  icp.align(*refined);
  const Eigen::Matrix4f pose = icp.getFinalTransformation() * hypothesis.model_in_scene;
  int inliers = 0;
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (const auto& p : *refined) {
    inliers += scene_tree.nearestKSearch(p, 1, index, squared) == 1 &&
               squared[0] < static_cast<float>(inlier_distance * inlier_distance);
  }
  FoundModel found;
  found.model_in_scene.matrix() = pose.cast<double>();
  found.correspondences = hypothesis.correspondences;
  found.coverage = static_cast<double>(inliers) / static_cast<double>(refined->size());
  return found;
}

}  // namespace

void FindModelParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("model_sampling", model_sampling, Range::above(0.0), "m",
        "distance of keypoints in the model");
  visit("scene_sampling", scene_sampling, Range::above(0.0), "m",
        "distance of keypoints in the scene");
  visit("descriptor_radius", descriptor_radius, Range::above(0.0), "m", "of SHOT descriptors");
  visit("consistency_distance", consistency_distance, Range::above(0.0), "m",
        "by which lengths of two correspondences may differ");
  visit("min_correspondences", min_correspondences, Range::atLeast(3), "", "of a pose");
  visit("max_hypotheses", max_hypotheses, Range::atLeast(1), "",
        "number of poses that are refined");
  visit("inlier_distance", inlier_distance, Range::above(0.0), "m",
        "of a point of the model to the scene");
}

void FindModelParams::validate() const {
  hyselam::checkParameters(*this);
}

std::vector<FoundModel> findModel(const OrganizedCloud& model, const OrganizedCloud& scene,
                                  const FindModelParams& params) {
  params.validate();
  const KeypointCloud in_model =
      describeKeypoints(model, "model", params.model_sampling, params.descriptor_radius);
  const KeypointCloud in_scene =
      describeKeypoints(scene, "scene", params.scene_sampling, params.descriptor_radius);
  pcl::KdTreeFLANN<pcl::PointXYZ> scene_tree;
  scene_tree.setInputCloud(in_scene.all);
  std::vector<FoundModel> found;
  for (const PoseHypothesis& each : groupCorrespondences(in_model, in_scene, params)) {
    found.push_back(refine(each, in_model, in_scene, scene_tree, params.inlier_distance));
  }
  std::stable_sort(found.begin(), found.end(), [](const FoundModel& a, const FoundModel& b) {
    return a.coverage > b.coverage;
  });
  return found;
}

}  // namespace hyselam_objects

#include "hyselam_objects/pcl/find_model.hpp"

#include <pcl/common/transforms.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/recognition/cg/geometric_consistency.h>
#include <pcl/registration/icp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/pose2.hpp"
#include "keypoint_cloud.hpp"
#include "model_evidence.hpp"

namespace hyselam_objects {
namespace {

/// Pairs of a keypoint of the model and one of the scene with similar descriptors.
pcl::CorrespondencesPtr matchDescriptors(const KeypointCloud& model, const KeypointCloud& scene) {
  constexpr float kMaxSquaredDistance = 0.25f;  // of SHOT descriptors, as in PCL's tutorial
  pcl::KdTreeFLANN<pcl::SHOT352> nearest;
  pcl::CorrespondencesPtr pairs(new pcl::Correspondences);
  if (scene.keypoints->empty()) return pairs;
  nearest.setInputCloud(model.descriptors);
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

/// One view of the scene.
struct Look {
  Eigen::Matrix4f camera;  ///< in the frame of all looks
  KeypointCloud points;    ///< in its own frame
  SceneView view;
  pcl::KdTreeFLANN<pcl::PointXYZ>::Ptr tree;  ///< of all points, where it is not one view
};

Look lookAt(const PlacedView& view, const OrganizedCloud& described, const KeypointCloud& model,
            const FindModelParams& params) {
  Look out{
      view.camera.matrix(), describeScene(described, model, params), SceneView(view.cloud), {}};
  if (!out.view.isOne()) {
    out.tree.reset(new pcl::KdTreeFLANN<pcl::PointXYZ>);
    out.tree->setInputCloud(out.points.all);
  }
  return out;
}

struct PoseHypothesis {
  Eigen::Matrix4f model;  ///< in the scene
  std::size_t correspondences = 0;
  int looks = 1;  ///< that suggest it
};

/// Poses that many correspondences agree on, those with most first, at most `max_hypotheses`.
std::vector<PoseHypothesis> groupCorrespondences(const KeypointCloud& model,
                                                 const KeypointCloud& scene,
                                                 const FindModelParams& params) {
  const pcl::CorrespondencesPtr pairs = matchDescriptors(model, scene);
  if (pairs->empty()) return {};
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> poses;
  std::vector<pcl::Correspondences> groups;
  pcl::GeometricConsistencyGrouping<pcl::PointXYZ, pcl::PointXYZ> grouping;
  grouping.setGCSize(params.consistency_distance);
  grouping.setGCThreshold(params.min_correspondences);
  grouping.setInputCloud(model.keypoints);
  grouping.setSceneCloud(scene.keypoints);
  grouping.setModelSceneCorrespondences(pairs);
  grouping.recognize(poses, groups);
  std::vector<PoseHypothesis> hypotheses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    hypotheses.push_back({poses[i], groups[i].size(), 1});
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) {
                     return a.correspondences > b.correspondences;
                   });
  hypotheses.resize(std::min(hypotheses.size(), static_cast<std::size_t>(params.max_hypotheses)));
  return hypotheses;
}

/// Refines a pose of the model by ICP; `farthest`: of corresponding points [m].
Eigen::Matrix4f refine(const Eigen::Matrix4f& pose, const KeypointCloud& model,
                       const Cloud::Ptr& scene, double farthest) {
  constexpr int kIterations = 20;
  Cloud::Ptr placed(new Cloud), refined(new Cloud);
  pcl::transformPointCloud(*model.keypoints, *placed, pose);
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setMaximumIterations(kIterations);
  icp.setMaxCorrespondenceDistance(farthest);
  icp.setInputSource(placed);
  icp.setInputTarget(scene);
  icp.align(*refined);
  return icp.getFinalTransformation() * pose;
}

bool isSamePose(const Eigen::Matrix4f& a, const Eigen::Matrix4f& b, const Eigen::Vector4f& middle) {
  constexpr float kNear = 0.02f;        // [m]
  constexpr float kNearTurn = 0.2618f;  // [rad], 15 degrees
  const Eigen::Matrix3f turn = a.topLeftCorner<3, 3>().transpose() * b.topLeftCorner<3, 3>();
  return (a * middle - b * middle).norm() < kNear && Eigen::AngleAxisf(turn).angle() < kNearTurn;
}

/// What several looks suggest, each pose once: with the correspondences of all of them.
std::vector<PoseHypothesis> joinLooks(const std::vector<std::vector<PoseHypothesis>>& of_looks,
                                      const Eigen::Vector4f& middle) {
  std::vector<PoseHypothesis> out;
  std::vector<std::size_t> last_look;
  for (std::size_t look = 0; look < of_looks.size(); ++look) {
    for (const PoseHypothesis& each : of_looks[look]) {  // those with most correspondences first
      std::size_t at = 0;
      while (at < out.size() && !isSamePose(out[at].model, each.model, middle)) ++at;
      if (at == out.size()) {
        out.push_back(each);
        last_look.push_back(look);
      } else if (last_look[at] != look) {
        out[at].correspondences += each.correspondences;
        ++out[at].looks;
        last_look[at] = look;
      }
    }
  }
  return out;
}

/// The poses of the model that each look suggests, in the frame of all.
std::vector<PoseHypothesis> suggestPoses(const KeypointCloud& model, const std::vector<Look>& looks,
                                         const FindModelParams& params) {
  constexpr double kFarthest = 0.02, kThenFarthest = 0.008;  // [m]
  std::vector<std::vector<PoseHypothesis>> of_looks;
  for (const Look& look : looks) {
    of_looks.push_back(groupCorrespondences(model, look.points, params));
    for (PoseHypothesis& each : of_looks.back()) {
      each.model = look.camera * refine(each.model, model, look.points.all, kFarthest);
    }
  }
  if (looks.size() == 1) return of_looks[0];
  Eigen::Vector4f middle;
  pcl::compute3DCentroid(*model.keypoints, middle);
  Cloud::Ptr all(new Cloud);
  for (const Look& look : looks) {
    Cloud placed;
    pcl::transformPointCloud(*look.points.all, placed, look.camera);
    *all += placed;
  }
  std::vector<PoseHypothesis> out = joinLooks(of_looks, middle);
  for (PoseHypothesis& each : out) {
    each.model = refine(each.model, model, all, kFarthest);
    each.model = refine(each.model, model, all, kThenFarthest);
  }
  return joinLooks({out}, middle);
}

/// Points of the surface of a model, to be judged at poses.
std::vector<Point> surfaceOf(const KeypointCloud& model) {
  constexpr std::size_t kMost = 3000;
  std::vector<Point> out;
  const std::size_t step = std::max<std::size_t>(1, model.all->size() / kMost);
  for (std::size_t i = 0; i < model.all->size(); i += step) {
    out.push_back((*model.all)[i].getVector3fMap());
  }
  return out;
}

/// Probability that the model is where it was found. Logistic regression on eight hypotheses in
/// each of 26 real scenes (learn*), of which half have a carton put into them
/// (bench/find_model_benchmark).
double probabilityOf(const FoundModel& found) {
  const double odds = -13.318 + 4.154 * std::log(static_cast<double>(found.correspondences)) +
                      3.783 * found.coverage + 1.940 * found.visible - 4.078 * found.flush;
  return 1.0 / (1.0 + std::exp(-odds));
}

struct JudgedModel {
  FoundModel found;
  std::vector<std::int64_t> pixels;  ///< of all looks that it explains, sorted
};

/// By how near the scene is, where it is not one view and nothing is known of what hides what.
void judgeByDistance(const std::vector<Point>& placed, const pcl::KdTreeFLANN<pcl::PointXYZ>& scene,
                     double distance, JudgedModel* out) {
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (const Point& p : placed) {
    if (scene.nearestKSearch({p.x(), p.y(), p.z()}, 1, index, squared) == 1 &&
        squared[0] < static_cast<float>(distance * distance)) {
      out->pixels.push_back(index[0]);
      out->found.coverage += 1.0 / static_cast<double>(placed.size());
    }
  }
  out->found.visible = 1.0;
  std::sort(out->pixels.begin(), out->pixels.end());
}

/// How much of the model is there at a pose, by what all looks could see of it.
JudgedModel judge(const PoseHypothesis& pose, const std::vector<Point>& surface,
                  const std::vector<Look>& looks, double inlier_distance) {
  JudgedModel out;
  FoundModel& found = out.found;
  found.model_in_scene.matrix() = pose.model.cast<double>();
  found.correspondences = pose.correspondences;
  found.looks = pose.looks;
  ModelEvidence evidence;
  std::int64_t first_pixel = 0;
  for (const Look& look : looks) {
    const Eigen::Isometry3f motion(Eigen::Isometry3f(look.camera).inverse() * pose.model);
    std::vector<Point> placed = surface;
    for (Point& p : placed) p = motion * p;
    if (!look.view.isOne()) {
      judgeByDistance(placed, *look.tree, inlier_distance, &out);
      found.probability = probabilityOf(found);
      return out;  // several looks are views
    }
    std::vector<std::int32_t> explains;
    evidence += look.view.judge(placed, inlier_distance, &explains);
    for (const std::int32_t pixel : explains) out.pixels.push_back(first_pixel + pixel);
    first_pixel += std::int64_t{1} << 32;
  }
  found.coverage = evidence.coverage();
  found.visible = evidence.visible();
  found.flush = evidence.flushShare();
  found.probability = probabilityOf(found);
  return out;
}

/// The likely ones, the best first; of those that explain the same part of the scene the best.
std::vector<FoundModel> bestOf(std::vector<JudgedModel> judged, double min_probability) {
  constexpr double kMostShared = 0.2;  // of what one explains
  std::stable_sort(judged.begin(), judged.end(), [](const JudgedModel& a, const JudgedModel& b) {
    return a.found.probability > b.found.probability;
  });
  std::vector<FoundModel> out;
  std::vector<std::int64_t> explained;
  for (const JudgedModel& each : judged) {
    if (each.found.probability < min_probability) break;
    std::vector<std::int64_t> shared;
    std::set_intersection(each.pixels.begin(), each.pixels.end(), explained.begin(),
                          explained.end(), std::back_inserter(shared));
    if (static_cast<double>(shared.size()) >
        kMostShared * static_cast<double>(each.pixels.size())) {
      continue;
    }
    out.push_back(each.found);
    std::vector<std::int64_t> all;
    std::set_union(each.pixels.begin(), each.pixels.end(), explained.begin(), explained.end(),
                   std::back_inserter(all));
    explained = std::move(all);
  }
  return out;
}

}  // namespace

void FindModelParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("surface_sampling", surface_sampling, Range::above(0.0), "m",
        "distance of the points that both clouds are thinned to");
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
  visit("min_probability", min_probability, Range::between(0.0, 1.0), "", "of a pose that is told");
}

void FindModelParams::validate() const {
  hyselam::checkParameters(*this);
}

std::vector<FoundModel> findModel(const OrganizedCloud& model, const OrganizedCloud& scene,
                                  const FindModelParams& params) {
  return findModel(SurfaceModel{model, {}}, scene, params);
}

std::vector<FoundModel> findModel(const SurfaceModel& model, const OrganizedCloud& scene,
                                  const FindModelParams& params) {
  return findModel(model, std::vector<PlacedView>{{scene, Eigen::Isometry3f::Identity()}}, params);
}

std::vector<FoundModel> findModel(const SurfaceModel& model, const std::vector<PlacedView>& scene,
                                  const FindModelParams& params) {
  params.validate();
  if (scene.empty()) throw hyselam::InputError("scene", "", "has no view");
  const KeypointCloud in_model = describeModel(model, params);
  std::vector<Look> looks;
  for (const PlacedView& view : scene) {
    const OrganizedCloud described = scene.size() > 1 ? thingsOf(view.cloud) : view.cloud;
    looks.push_back(lookAt(view, described, in_model, params));
    if (scene.size() > 1 && !looks.back().view.isOne()) {
      throw hyselam::InputError("view " + std::to_string(looks.size()), "",
                                "is not what a camera at its origin sees");
    }
  }
  const std::vector<Point> surface = surfaceOf(in_model);
  std::vector<JudgedModel> judged;
  for (const PoseHypothesis& each : suggestPoses(in_model, looks, params)) {
    judged.push_back(judge(each, surface, looks, params.inlier_distance));
  }
  return bestOf(std::move(judged), params.min_probability);
}

}  // namespace hyselam_objects

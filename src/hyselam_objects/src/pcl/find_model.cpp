#include "hyselam_objects/pcl/find_model.hpp"

#include <pcl/common/transforms.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/shot.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/recognition/cg/geometric_consistency.h>
#include <pcl/registration/icp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "model_evidence.hpp"

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

/// One point (the mean) in each cube of space, however far apart they are: PCL's grid numbers its
/// cubes by 32 bits and gives back its input where these do not do.
Cloud::Ptr thinned(const Cloud::Ptr& cloud, double side, const char* name) {
  using Cube = std::array<std::int64_t, 3>;  // z, y, x
  constexpr double kMostCubes = 1e18;        // from the origin; farther ones are one
  std::vector<std::pair<Cube, std::size_t>> places;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const auto cubeOf = [&](float x) {
      const double cube = std::floor(static_cast<double>(x) / side);
      return static_cast<std::int64_t>(std::clamp(cube, -kMostCubes, kMostCubes));
    };
    const pcl::PointXYZ& p = (*cloud)[i];
    places.push_back({{cubeOf(p.z), cubeOf(p.y), cubeOf(p.x)}, i});
  }
  std::sort(places.begin(), places.end());
  Cloud::Ptr out(new Cloud);
  for (std::size_t i = 0, end = 0; i < places.size(); i = end) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (; end < places.size() && places[end].first == places[i].first; ++end) {
      sum += (*cloud)[places[end].second].getVector3fMap().cast<double>();
    }
    const Eigen::Vector3f mean = (sum / static_cast<double>(end - i)).cast<float>();
    out->push_back({mean.x(), mean.y(), mean.z()});
  }
  if (out->size() < kLeastPoints) {
    throw hyselam::InputError(name, "", "has fewer than 100 usable points in different places");
  }
  return out;
}

struct KeypointCloud {
  Cloud::Ptr all, keypoints;
  Normals::Ptr normals;    ///< of all
  Shots::Ptr descriptors;  ///< of the keypoints
};

/// How many points are within `radius` of each keypoint, counted up to `most`.
std::vector<int> neighborsOf(const KeypointCloud& cloud, double radius, int most) {
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(cloud.all);
  std::vector<int> counts, index;
  std::vector<float> squared;
  for (const pcl::PointXYZ& p : *cloud.keypoints) {
    counts.push_back(tree.radiusSearch(p, radius, index, squared, static_cast<unsigned>(most)));
  }
  return counts;
}

void describe(KeypointCloud* cloud, double radius) {
  cloud->descriptors.reset(new Shots);
  if (cloud->keypoints->empty()) return;
  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> shot;
  shot.setRadiusSearch(radius);
  shot.setInputCloud(cloud->keypoints);
  shot.setInputNormals(cloud->normals);
  shot.setSearchSurface(cloud->all);
  shot.compute(*cloud->descriptors);
}

/// `least`: points within `radius` that a keypoint has. Far from a camera surfaces become points
/// here and there: many, that look like nothing.
KeypointCloud describeKeypoints(const Cloud::Ptr& cloud, const Point& seen_from, const char* name,
                                double surface, double sampling, double radius, int least) {
  KeypointCloud out;
  out.all = thinned(cloud, surface, name);
  out.normals.reset(new Normals);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimate;
  estimate.setKSearch(10);
  estimate.setInputCloud(out.all);
  estimate.setViewPoint(seen_from.x(), seen_from.y(), seen_from.z());
  estimate.compute(*out.normals);
  out.keypoints.reset(new Cloud);
  pcl::UniformSampling<pcl::PointXYZ> sample;
  sample.setInputCloud(out.all);
  sample.setRadiusSearch(sampling);
  sample.filter(*out.keypoints);
  if (least > 1) {
    const std::vector<int> neighbors = neighborsOf(out, radius, least);
    Cloud::Ptr dense(new Cloud);
    for (std::size_t i = 0; i < neighbors.size(); ++i) {
      if (neighbors[i] >= least) dense->push_back((*out.keypoints)[i]);
    }
    out.keypoints = dense;
  }
  describe(&out, radius);
  return out;
}

/// The keypoints of all views of a model, each described by what its camera saw: normals point to
/// where it was, and of a thin part there is the near side only, as in a scene.
KeypointCloud describeModel(const SurfaceModel& model, const FindModelParams& params) {
  const Cloud::Ptr all = toPcl(model.cloud, "model");
  const auto describeView = [&](const Cloud::Ptr& view, const Point& seen_from) {
    return describeKeypoints(view, seen_from, "model", params.surface_sampling,
                             params.model_sampling, params.descriptor_radius, 1);
  };
  if (model.seen_from.empty()) return describeView(all, Point::Zero());
  KeypointCloud out;
  out.keypoints.reset(new Cloud);
  out.descriptors.reset(new Shots);
  for (std::size_t i = 0, end = 0; i < model.cloud.size(); i = end) {
    OrganizedCloud view;
    for (; end < model.cloud.size() && model.seen_from.at(end) == model.seen_from[i]; ++end) {
      view.points.push_back(model.cloud.points[end]);
    }
    const KeypointCloud described = describeView(toPcl(view, "model"), model.seen_from[i]);
    *out.keypoints += *described.keypoints;
    *out.descriptors += *described.descriptors;
  }
  out.all = thinned(all, params.surface_sampling, "model");
  return out;
}

/// What a keypoint of a scene has around it at the least, to be like one of the model: a quarter,
/// which is a surface sampled half as densely.
int leastNeighbors(const KeypointCloud& model, const FindModelParams& params) {
  constexpr int kMost = 1000;
  std::vector<int> counts = neighborsOf(model, params.descriptor_radius, kMost);
  if (counts.empty()) return 1;
  const auto median = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), median, counts.end());
  return std::max(1, *median / 4);
}

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

struct PoseHypothesis {
  Eigen::Matrix4f model_in_scene;
  std::size_t correspondences = 0;
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
    hypotheses.push_back({poses[i], groups[i].size()});
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) {
                     return a.correspondences > b.correspondences;
                   });
  hypotheses.resize(std::min(hypotheses.size(), static_cast<std::size_t>(params.max_hypotheses)));
  return hypotheses;
}

/// Refines a hypothesis by ICP.
Eigen::Matrix4f refine(const PoseHypothesis& hypothesis, const KeypointCloud& model,
                       const KeypointCloud& scene) {
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
  return icp.getFinalTransformation() * hypothesis.model_in_scene;
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
  std::vector<std::int32_t> pixels;  ///< of the scene that it explains, sorted
};

/// How much of the model is there at a pose, by what can be seen of it.
JudgedModel judge(const Eigen::Matrix4f& pose, std::size_t correspondences,
                  const std::vector<Point>& surface, const SceneView& view,
                  const pcl::KdTreeFLANN<pcl::PointXYZ>& scene_tree, double inlier_distance) {
  std::vector<Point> placed = surface;
  const Eigen::Isometry3f motion(pose);
  for (Point& p : placed) p = motion * p;
  JudgedModel out;
  FoundModel& found = out.found;
  found.model_in_scene.matrix() = pose.cast<double>();
  found.correspondences = correspondences;
  if (view.isOne()) {
    ModelEvidence evidence = view.judge(placed, inlier_distance);
    found.coverage = evidence.coverage;
    found.visible = evidence.visible;
    found.flush = evidence.flush;
    out.pixels = std::move(evidence.pixels);
  } else {
    std::vector<int> index(1);
    std::vector<float> squared(1);
    for (const Point& p : placed) {
      if (scene_tree.nearestKSearch({p.x(), p.y(), p.z()}, 1, index, squared) == 1 &&
          squared[0] < static_cast<float>(inlier_distance * inlier_distance)) {
        out.pixels.push_back(index[0]);
        found.coverage += 1.0 / static_cast<double>(placed.size());
      }
    }
    found.visible = 1.0;
    std::sort(out.pixels.begin(), out.pixels.end());
  }
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
  std::vector<std::int32_t> explained;
  for (const JudgedModel& each : judged) {
    if (each.found.probability < min_probability) break;
    std::vector<std::int32_t> shared;
    std::set_intersection(each.pixels.begin(), each.pixels.end(), explained.begin(),
                          explained.end(), std::back_inserter(shared));
    if (static_cast<double>(shared.size()) >
        kMostShared * static_cast<double>(each.pixels.size())) {
      continue;
    }
    out.push_back(each.found);
    std::vector<std::int32_t> all;
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
  params.validate();
  const KeypointCloud in_model = describeModel(model, params);
  const KeypointCloud in_scene = describeKeypoints(
      toPcl(scene, "scene"), Point::Zero(), "scene", params.surface_sampling, params.scene_sampling,
      params.descriptor_radius, leastNeighbors(in_model, params));
  const SceneView view(scene);
  const std::vector<Point> surface = surfaceOf(in_model);
  pcl::KdTreeFLANN<pcl::PointXYZ> scene_tree;
  scene_tree.setInputCloud(in_scene.all);
  std::vector<JudgedModel> judged;
  for (const PoseHypothesis& each : groupCorrespondences(in_model, in_scene, params)) {
    judged.push_back(judge(refine(each, in_model, in_scene), each.correspondences, surface, view,
                           scene_tree, params.inlier_distance));
  }
  return bestOf(std::move(judged), params.min_probability);
}

}  // namespace hyselam_objects

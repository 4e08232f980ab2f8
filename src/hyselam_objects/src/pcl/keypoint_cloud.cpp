#include "keypoint_cloud.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/features/shot.h>
#include <pcl/filters/uniform_sampling.h>
#include <pcl/kdtree/kdtree_flann.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

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

}  // namespace

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

KeypointCloud describeScene(const OrganizedCloud& scene, const KeypointCloud& model,
                            const FindModelParams& params) {
  return describeKeypoints(toPcl(scene, "scene"), Point::Zero(), "scene", params.surface_sampling,
                           params.scene_sampling, params.descriptor_radius,
                           leastNeighbors(model, params));
}

OrganizedCloud thingsOf(const OrganizedCloud& scene) {
  const CloudSegmentation found = segmentCloud(scene);  // 2 ... are things
  if (found.objects == 0) return scene;
  OrganizedCloud out = scene;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (found.labels[i] < 2) {
      out.points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  return out;
}

}  // namespace hyselam_objects

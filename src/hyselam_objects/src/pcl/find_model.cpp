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
#include <numeric>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"

namespace hyselam_objects {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Shots = pcl::PointCloud<pcl::SHOT352>;

Cloud::Ptr toPcl(const OrganisedCloud& cloud, const char* name) {
  Cloud::Ptr out(new Cloud);
  for (const Point& p : cloud.points) {
    if (p.allFinite()) out->push_back({p.x(), p.y(), p.z()});
  }
  if (out->size() < 100) throw hyselam::InputError(name, "", "has fewer than 100 usable points");
  return out;
}

struct Described {
  Cloud::Ptr all, keys;
  Shots::Ptr shots;
};

Described describe(const OrganisedCloud& cloud, const char* name, double sampling, double radius) {
  Described out;
  out.all = toPcl(cloud, name);
  Normals::Ptr normals(new Normals);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimate;
  estimate.setKSearch(10);
  estimate.setInputCloud(out.all);
  estimate.compute(*normals);
  out.keys.reset(new Cloud);
  pcl::UniformSampling<pcl::PointXYZ> sample;
  sample.setInputCloud(out.all);
  sample.setRadiusSearch(sampling);
  sample.filter(*out.keys);
  out.shots.reset(new Shots);
  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> shot;
  shot.setRadiusSearch(radius);
  shot.setInputCloud(out.keys);
  shot.setInputNormals(normals);
  shot.setSearchSurface(out.all);
  shot.compute(*out.shots);
  return out;
}

}  // namespace

std::vector<FoundModel> findModel(const OrganisedCloud& model, const OrganisedCloud& scene,
                                  const FindModelParams& params) {
  using hyselam::require;
  require("model_sampling", params.model_sampling, params.model_sampling > 0.0, "> 0");
  require("scene_sampling", params.scene_sampling, params.scene_sampling > 0.0, "> 0");
  require("descriptor_radius", params.descriptor_radius, params.descriptor_radius > 0.0, "> 0");
  require("consistency", params.consistency, params.consistency > 0.0, "> 0");
  require("least", params.least, params.least >= 3, ">= 3");
  require("candidates", params.candidates, params.candidates >= 1, ">= 1");
  require("touch", params.touch, params.touch > 0.0, "> 0");
  const Described a = describe(model, "model", params.model_sampling, params.descriptor_radius);
  const Described b = describe(scene, "scene", params.scene_sampling, params.descriptor_radius);

  constexpr float kAlike = 0.25f;  // squared distance of SHOT descriptors
  pcl::KdTreeFLANN<pcl::SHOT352> nearest;
  nearest.setInputCloud(a.shots);
  pcl::CorrespondencesPtr pairs(new pcl::Correspondences);
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (std::size_t i = 0; i < b.shots->size(); ++i) {
    if (!std::isfinite((*b.shots)[i].descriptor[0])) continue;
    if (nearest.nearestKSearch((*b.shots)[i], 1, index, squared) == 1 && squared[0] < kAlike) {
      pairs->emplace_back(index[0], static_cast<int>(i), squared[0]);
    }
  }
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> poses;
  std::vector<pcl::Correspondences> groups;
  pcl::GeometricConsistencyGrouping<pcl::PointXYZ, pcl::PointXYZ> grouping;
  grouping.setGCSize(params.consistency);
  grouping.setGCThreshold(params.least);
  grouping.setInputCloud(a.keys);
  grouping.setSceneCloud(b.keys);
  grouping.setModelSceneCorrespondences(pairs);
  grouping.recognize(poses, groups);

  pcl::KdTreeFLANN<pcl::PointXYZ> on_scene;
  on_scene.setInputCloud(b.all);
  std::vector<FoundModel> found;
  std::vector<std::size_t> order(poses.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) {
    return groups[x].size() > groups[y].size();
  });
  order.resize(std::min(order.size(), static_cast<std::size_t>(params.candidates)));
  for (const std::size_t i : order) {
    Cloud::Ptr placed(new Cloud), refined(new Cloud);
    pcl::transformPointCloud(*a.keys, *placed, poses[i]);
    pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
    icp.setMaximumIterations(20);
    icp.setMaxCorrespondenceDistance(0.02);
    icp.setInputSource(placed);
    icp.setInputTarget(b.all);
    icp.align(*refined);
    FoundModel each;
    const Eigen::Matrix4f pose = icp.getFinalTransformation() * poses[i];
    each.model_in_scene.matrix() = pose.cast<double>();
    each.correspondences = groups[i].size();
    int touching = 0;
    for (const auto& p : *refined) {
      touching += on_scene.nearestKSearch(p, 1, index, squared) == 1 &&
                  squared[0] < static_cast<float>(params.touch * params.touch);
    }
    each.covered = static_cast<double>(touching) / static_cast<double>(refined->size());
    found.push_back(each);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const FoundModel& x, const FoundModel& y) { return x.covered > y.covered; });
  return found;
}

}  // namespace hyselam_objects

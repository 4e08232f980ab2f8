#include "hyselam_objects/pcl/unorganised.hpp"

#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/sac_model_plane.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

void check(const UnorganisedParams& p) {
  using hyselam::ParameterError;
  for (const auto& [name, value] : {std::pair<const char*, double>{"voxel", p.voxel},
                                    {"support_distance", p.support_distance},
                                    {"gap", p.gap},
                                    {"tallest", p.tallest}}) {
    if (!(value > 0.0 && value <= 10.0)) throw ParameterError(name, value, "within (0, 10]");
  }
  if (p.smallest < 1) throw ParameterError("smallest", p.smallest, ">= 1");
}

}  // namespace

Segmentation segmentUnorganised(const OrganisedCloud& cloud, const Eigen::Vector3f& sensor,
                                const UnorganisedParams& params) {
  check(params);
  Segmentation out;
  out.labels.assign(cloud.size(), 0);
  Cloud::Ptr all(new Cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.isValid(i)) continue;
    out.labels[i] = 1;
    const Point& p = cloud.points[i];
    all->push_back({p.x(), p.y(), p.z()});
  }
  Cloud::Ptr thin(new Cloud);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(all);
  const auto leaf = static_cast<float>(params.voxel);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.filter(*thin);
  if (thin->size() < 10) return out;

  pcl::SACSegmentation<pcl::PointXYZ> plane_finder;  // its random numbers begin the same every time
  plane_finder.setOptimizeCoefficients(true);
  plane_finder.setModelType(pcl::SACMODEL_PLANE);
  plane_finder.setMethodType(pcl::SAC_RANSAC);
  plane_finder.setMaxIterations(500);
  plane_finder.setDistanceThreshold(params.support_distance);
  plane_finder.setInputCloud(thin);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  plane_finder.segment(inliers, plane);
  if (inliers.indices.empty()) return out;
  Eigen::Vector3f normal(plane.values[0], plane.values[1], plane.values[2]);
  const float length = normal.norm();
  normal /= length;
  float distance = -plane.values[3] / length;
  if (normal.dot(sensor) < distance) {
    normal = -normal;
    distance = -distance;
  }
  out.support = Plane{normal, distance};

  Cloud::Ptr above(new Cloud);
  for (const pcl::PointXYZ& p : *thin) {
    const float height = out.support->heightOf(p.getVector3fMap());
    if (height > static_cast<float>(params.support_distance) &&
        height < static_cast<float>(params.tallest)) {
      above->push_back(p);
    }
  }
  if (above->empty()) return out;
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(above);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> clusters;
  clusters.setClusterTolerance(params.gap);
  clusters.setMinClusterSize(params.smallest);
  clusters.setSearchMethod(tree);
  clusters.setInputCloud(above);
  std::vector<pcl::PointIndices> found;
  clusters.extract(found);
  const auto nearest = [&](const pcl::PointIndices& cluster) {
    float least = std::numeric_limits<float>::infinity();
    for (const int i : cluster.indices) {
      least =
          std::min(least, ((*above)[static_cast<std::size_t>(i)].getVector3fMap() - sensor).norm());
    }
    return least;
  };
  std::vector<std::pair<float, std::size_t>> order;
  for (std::size_t k = 0; k < found.size(); ++k) order.emplace_back(nearest(found[k]), k);
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> label(above->size(), 1);
  for (const auto& [range, k] : order) {
    ++out.objects;
    for (const int i : found[k].indices) label[static_cast<std::size_t>(i)] = out.objects + 1;
  }
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (out.labels[i] == 0) continue;
    const Point& p = cloud.points[i];
    const float height = out.support->heightOf(p);
    if (height < static_cast<float>(params.support_distance) ||
        height > static_cast<float>(params.tallest)) {
      continue;
    }
    if (tree->nearestKSearch({p.x(), p.y(), p.z()}, 1, index, squared) > 0 &&
        squared[0] < 4.0f * leaf * leaf) {
      out.labels[i] = label[static_cast<std::size_t>(index[0])];
    }
  }
  return out;
}

}  // namespace hyselam_objects

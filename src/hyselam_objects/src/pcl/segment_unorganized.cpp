#include "hyselam_objects/pcl/segment_unorganized.hpp"

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

Cloud::Ptr validPoints(const OrganizedCloud& cloud) {
  Cloud::Ptr valid(new Cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Point& p = cloud.points[i];
    if (cloud.isValid(i)) valid->push_back({p.x(), p.y(), p.z()});
  }
  return valid;
}

Cloud::Ptr downsample(const Cloud::Ptr& cloud, float voxel_size) {
  Cloud::Ptr out(new Cloud);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(voxel_size, voxel_size, voxel_size);
  grid.filter(*out);
  return out;
}

/// The plane with most inliers, its normal on the side of the sensor.
std::optional<Plane> findSupport(const Cloud::Ptr& cloud, double inlier_distance,
                                 const Eigen::Vector3f& sensor) {
  constexpr int kIterations = 500;
  pcl::SACSegmentation<pcl::PointXYZ> plane_finder;  // its random numbers are the same every time
  plane_finder.setOptimizeCoefficients(true);
  plane_finder.setModelType(pcl::SACMODEL_PLANE);
  plane_finder.setMethodType(pcl::SAC_RANSAC);
  plane_finder.setMaxIterations(kIterations);
  plane_finder.setDistanceThreshold(inlier_distance);
  plane_finder.setInputCloud(cloud);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  plane_finder.segment(inliers, plane);
  if (inliers.indices.empty()) return std::nullopt;
  Eigen::Vector3f normal(plane.values[0], plane.values[1], plane.values[2]);
  const float length = normal.norm();
  normal /= length;
  float distance = -plane.values[3] / length;
  if (normal.dot(sensor) < distance) {
    normal = -normal;
    distance = -distance;
  }
  return Plane{normal, distance};
}

/// Points above the support in clusters, and the label of each: 2 ... in the order of the clusters'
/// distance from the sensor, 1 in no cluster.
struct Clusters {
  Cloud::Ptr points{new Cloud};
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree{new pcl::search::KdTree<pcl::PointXYZ>};
  std::vector<std::uint32_t> labels;
  std::uint32_t count = 0;
};

Clusters clusterAbove(const Cloud& cloud, const Plane& support, const Eigen::Vector3f& sensor,
                      const UnorganizedParams& params) {
  Clusters out;
  for (const pcl::PointXYZ& p : cloud) {
    const float height = support.heightOf(p.getVector3fMap());
    if (height > static_cast<float>(params.support_distance) &&
        height < static_cast<float>(params.max_object_height)) {
      out.points->push_back(p);
    }
  }
  if (out.points->empty()) return out;
  out.tree->setInputCloud(out.points);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(params.cluster_gap);
  extraction.setMinClusterSize(params.min_points);
  extraction.setSearchMethod(out.tree);
  extraction.setInputCloud(out.points);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  std::vector<std::pair<float, std::size_t>> order;
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    float nearest = std::numeric_limits<float>::infinity();
    for (const int i : clusters[k].indices) {
      const pcl::PointXYZ& p = (*out.points)[static_cast<std::size_t>(i)];
      nearest = std::min(nearest, (p.getVector3fMap() - sensor).norm());
    }
    order.emplace_back(nearest, k);
  }
  std::sort(order.begin(), order.end());
  out.labels.assign(out.points->size(), 1);
  for (const auto& [range, k] : order) {
    ++out.count;
    for (const int i : clusters[k].indices) {
      out.labels[static_cast<std::size_t>(i)] = out.count + 1;
    }
  }
  return out;
}

/// The full cloud: each point between support and largest height gets the label of the nearest
/// point of the clusters.
void labelPoints(const OrganizedCloud& cloud, const Clusters& clusters,
                 const UnorganizedParams& params, CloudSegmentation& out) {
  const auto voxel = static_cast<float>(params.voxel_size);
  const float max_squared_distance = 4.0f * voxel * voxel;
  std::vector<int> index(1);
  std::vector<float> squared(1);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (out.labels[i] == 0) continue;
    const Point& p = cloud.points[i];
    const float height = out.support->heightOf(p);
    if (height < static_cast<float>(params.support_distance) ||
        height > static_cast<float>(params.max_object_height)) {
      continue;
    }
    if (clusters.tree->nearestKSearch({p.x(), p.y(), p.z()}, 1, index, squared) > 0 &&
        squared[0] < max_squared_distance) {
      out.labels[i] = clusters.labels[static_cast<std::size_t>(index[0])];
    }
  }
}

}  // namespace

void UnorganizedParams::describe(hyselam::ParameterVisitor& visit) {
  const hyselam::Range length = hyselam::Range::aboveUpTo(0.0, 10.0);
  visit("voxel_size", voxel_size, length, "m", "of the voxel grid filter");
  visit("support_distance", support_distance, length, "m",
        "nearer points belong to the support plane");
  visit("cluster_gap", cluster_gap, length, "m", "points nearer than this belong together");
  visit("max_object_height", max_object_height, length, "m", "above the support plane");
  visit("min_points", min_points, hyselam::Range::atLeast(1), "", "of a filtered object");
}

void UnorganizedParams::validate() const {
  hyselam::checkParameters(*this);
}

CloudSegmentation segmentUnorganized(const OrganizedCloud& cloud, const Eigen::Vector3f& sensor,
                                     const UnorganizedParams& params) {
  constexpr std::size_t kMinPoints = 10;  // of a plane worth the search
  checkCloud(cloud);
  params.validate();
  CloudSegmentation out;
  out.labels.assign(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.isValid(i)) out.labels[i] = 1;
  }
  const Cloud::Ptr filtered = downsample(validPoints(cloud), static_cast<float>(params.voxel_size));
  if (filtered->size() < kMinPoints) return out;
  out.support = findSupport(filtered, params.support_distance, sensor);
  if (!out.support) return out;
  const Clusters clusters = clusterAbove(*filtered, *out.support, sensor, params);
  if (clusters.points->empty()) return out;
  out.objects = clusters.count;
  labelPoints(cloud, clusters, params, out);
  return out;
}

}  // namespace hyselam_objects

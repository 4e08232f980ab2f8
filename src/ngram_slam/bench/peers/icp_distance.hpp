// Point matching as the thesis compares with (4.3.2, 5.3.2): PCL's ICP over the points of two
// places.
#pragma once

#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

#include <limits>
#include <memory>
#include <vector>

#include "stations.hpp"

namespace ngram_slam_peers {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

inline Cloud::Ptr cloudOf(const std::vector<hyselam::Point2>& points) {
  auto cloud = Cloud::Ptr(new Cloud);
  for (const hyselam::Point2& p : points) {
    cloud->push_back(pcl::PointXYZ(static_cast<float>(p.x), static_cast<float>(p.y), 0.0F));
  }
  return cloud;
}

class IcpDistance {
 public:
  IcpDistance() {
    icp_.setMaximumIterations(30);
    icp_.setMaxCorrespondenceDistance(1.0);
    icp_.setTransformationEpsilon(1e-6);
  }
  /// Mean squared distance of the points after matching [m^2]; infinity without a match.
  double operator()(const Cloud::Ptr& newer, const Cloud::Ptr& older) {
    if (newer->size() < 10 || older->size() < 10) return std::numeric_limits<double>::infinity();
    icp_.setInputSource(newer);
    icp_.setInputTarget(older);
    icp_.align(aligned_);
    return icp_.hasConverged() ? icp_.getFitnessScore(1.0)
                               : std::numeric_limits<double>::infinity();
  }

 private:
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp_;
  Cloud aligned_;
};

}  // namespace ngram_slam_peers

// Pose estimate of a particle set: mean and covariance of the heaviest cluster.
#pragma once

#include <Eigen/Core>

#include "fsd_localization/filter/particles.hpp"

namespace fsd_localization {

struct ClusterParams {
  double cell = 0.5;                      ///< particles in touching bins of this side [m] ...
  double angle = hyselam::radians(15.0);  ///< ... and this angle [rad] form a cluster
};

/// In the frame of the particles. Covariance over (x, y, theta) [m^2, m rad, rad^2].
struct PoseEstimate {
  hyselam::Pose2 mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double cluster_weight = 0.0;  ///< share of the weight that the cluster holds, 0..1
  int clusters = 0;             ///< number of clusters with at least 1 % of the weight each
  std::size_t bins = 0;         ///< number of occupied bins: a measure of the remaining ambiguity

  /// Larger of the standard deviations along the principal axes of the position [m].
  double positionStddev() const;
};

/// The mean and covariance of the heaviest cluster. While the particles fill thousands of bins each
/// bin counts as a cluster of its own. Without any weight there is no cluster (cluster_weight 0).
PoseEstimate estimatePose(const Particles& particles, const ClusterParams& params = {});

}  // namespace fsd_localization

// Covariances of single poses.
#pragma once

#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// One factorization, then any pose at the cost of a path to the root of the elimination tree.
class Marginals {
 public:
  /// `system` must outlive this. @throws hyselam::InputError when the edges do not determine the
  /// poses.
  Marginals(const PoseSystem& system, const std::vector<hyselam::Pose2>& poses,
            const std::vector<double>& weights);
  /// Of (x, y, theta), in the frame of the graph, given the first pose of its component.
  /// @throws hyselam::InputError for an index out of range.
  Eigen::Matrix3d covariance(int pose) const;

 private:
  const PoseSystem& system_;
  int poses_;
  BlockCholesky<Block3> factor_;
};

}  // namespace hyselam_pose_graph

#include "marginals.hpp"

#include "hyselam_common/errors.hpp"

namespace hyselam_pose_graph {

using hyselam::InputError;

Marginals::Marginals(const PoseSystem& system, const std::vector<hyselam::Pose2>& poses,
                     const std::vector<double>& weights)
    : system_(system), poses_(static_cast<int>(poses.size())), factor_(system.pattern()) {
  std::vector<PoseSystem::Vector> b;
  system_.linearize(PoseSystem::system(poses), weights, 0.0, &factor_, &b);
  if (!factorPoses(&factor_))
    throw InputError("pose graph", "", "the edges do not determine the poses");
}

Eigen::Matrix3d Marginals::covariance(int pose) const {
  if (pose < 0 || pose >= poses_)
    throw InputError("covariances", "pose " + std::to_string(pose), "does not exist");
  const int row = system_.row(pose);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  if (row < 0) return covariance;
  // (L L^T)^-1 = L^-T L^-1: its block of the pose is a sum over columns of L^-1.
  std::vector<PoseSystem::Vector> column[3];
  for (int k = 0; k < 3; ++k) {
    PoseSystem::Vector unit{};
    unit[k] = 1.0;
    factor_.solveLowerFrom(row, unit, [&](const PoseSystem::Vector& x) { column[k].push_back(x); });
  }
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < column[r].size(); ++i) {
        const PoseSystem::Vector p = column[r][i] * column[k][i];
        covariance(r, k) += p[0] + p[1] + p[2];
      }
  return covariance;
}

}  // namespace hyselam_pose_graph

// Poses of the plane connected by relative measurements: the back end of graph SLAM (Maffei 2017,
// 2.1.3.1 and appendix B).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam_pose_graph {

/// A measurement of the pose `to` seen from the pose `from`, both indices into PoseGraph::poses.
struct PoseEdge {
  int from = 0;
  int to = 0;
  hyselam::Pose2 measured;  ///< `to` in `from`
  /// Inverse covariance of (x, y, theta) of the error, in the frame of `to` as measured [1/m^2,
  /// 1/(m rad), 1/rad^2]; symmetric, positive semidefinite.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

struct PoseGraph {
  std::vector<std::int64_t> ids;      ///< names of the poses in files; as many as poses, unique
  std::vector<hyselam::Pose2> poses;  ///< in one frame
  std::vector<PoseEdge> edges;

  /// @throws hyselam::InputError naming the edge that refers to a missing pose, the edge or pose
  /// that is not finite, or the edge whose information is not symmetric positive semidefinite.
  void validate() const;
};

/// @throws hyselam::InputError, naming the edge `name`, for an edge that PoseGraph::validate
/// rejects in a graph of `poses` poses.
void validateEdge(const PoseEdge& edge, std::size_t poses, const std::string& name);

/// An edge between poses that follow each other in the list: odometry, as opposed to a loop.
inline bool isOdometry(const PoseEdge& e) {
  return e.to == e.from + 1 || e.from == e.to + 1;
}

/// e = (R_z^T (R_i^T (t_j - t_i) - t_z), wrap(theta_j - theta_i - theta_z)), as g2o defines it.
Eigen::Vector3d edgeError(const PoseEdge& edge, const hyselam::Pose2& from,
                          const hyselam::Pose2& to);
/// e^T Omega e of one edge.
double edgeCost(const PoseEdge& edge, const std::vector<hyselam::Pose2>& poses);
/// The sum over all edges, without a factor 1/2.
double graphCost(const PoseGraph& graph, const std::vector<hyselam::Pose2>& poses);

/// Poses composed along measurements, from the first pose of each connected component: along
/// odometry where there is any, else along a breadth-first tree. The first pose of each component
/// keeps its value.
std::vector<hyselam::Pose2> composedPoses(const PoseGraph& graph);

/// The connected component of each pose, numbered from 0 in the order of their first poses.
std::vector<int> connectedComponents(const PoseGraph& graph);

}  // namespace hyselam_pose_graph

#include "consistent_loops.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <optional>

namespace hyselam_pose_graph {

namespace {

using hyselam::Pose2;

constexpr double kChi2Median = 2.366;  // with three degrees of freedom

/// A relative pose and the covariance of its error, in the frame of its target.
struct RelativePose {
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// The adjoint of p^-1: transforms an error from the frame before `p` to the one after it.
Eigen::Matrix3d inverseAdjoint(const Pose2& p) {
  const Pose2 back = p.inverse();
  const double c = std::cos(back.theta), s = std::sin(back.theta);
  Eigen::Matrix3d a;
  a << c, -s, back.y, s, c, -back.x, 0.0, 0.0, 1.0;
  return a;
}

RelativePose operator*(const RelativePose& a, const RelativePose& b) {
  const Eigen::Matrix3d m = inverseAdjoint(b.pose);
  return {a.pose * b.pose, m * a.covariance * m.transpose() + b.covariance};
}

RelativePose inverse(const RelativePose& a) {
  const Eigen::Matrix3d m = inverseAdjoint(a.pose.inverse());
  return {a.pose.inverse(), m * a.covariance * m.transpose()};
}

std::optional<RelativePose> relativePoseOf(const PoseEdge& edge) {
  const Eigen::LDLT<Eigen::Matrix3d> solver(edge.information);
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) return {};
  return RelativePose{edge.measured, solver.solve(Eigen::Matrix3d::Identity())};
}

class OdometryChain {
 public:
  explicit OdometryChain(const PoseGraph& graph) : steps_(graph.poses.size()) {
    for (const PoseEdge& edge : graph.edges) {
      if (!isOdometry(edge)) continue;
      const std::optional<RelativePose> measured = relativePoseOf(edge);
      const bool forward = edge.to == edge.from + 1;
      auto& place = steps_[static_cast<std::size_t>(std::min(edge.from, edge.to))];
      if (measured && !place) place = forward ? *measured : inverse(*measured);
    }
  }
  /// The poses up to `count` after `pose`, seen from it along odometry, itself first; fewer where
  /// odometry ends.
  std::vector<RelativePose> after(int pose, int count) const {
    std::vector<RelativePose> path(1);
    for (int i = pose; i < pose + count && i + 1 < static_cast<int>(steps_.size()); ++i) {
      const auto& step = steps_[static_cast<std::size_t>(i)];
      if (!step) break;
      path.push_back(path.back() * *step);
    }
    return path;
  }

 private:
  std::vector<std::optional<RelativePose>> steps_;  ///< from each pose to the next
};

/// A loop from the lower of its poses to the higher.
struct Loop {
  std::size_t edge;
  int from, to;
  RelativePose measured;
};

double squaredError(const RelativePose& a, const RelativePose& b) {
  const RelativePose e = inverse(a) * b;
  const Eigen::Vector3d v(e.pose.x, e.pose.y, e.pose.theta);
  return v.dot(e.covariance.ldlt().solve(v));
}

}  // namespace

ConsistentLoops findConsistentLoops(const PoseGraph& graph, double max_squared_error,
                                    int max_distance) {
  ConsistentLoops result;
  result.support.assign(graph.edges.size(), 0);
  const OdometryChain chain(graph);
  std::vector<Loop> loops;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const PoseEdge& edge = graph.edges[k];
    if (isOdometry(edge)) continue;
    const std::optional<RelativePose> measured = relativePoseOf(edge);
    if (!measured) continue;
    const bool forward = edge.from < edge.to;
    loops.push_back({k, std::min(edge.from, edge.to), std::max(edge.from, edge.to),
                     forward ? *measured : inverse(*measured)});
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const Loop& a, const Loop& b) { return a.from < b.from; });
  // Paths along odometry, computed when first needed.
  std::vector<std::vector<RelativePose>> paths(graph.poses.size());
  const auto between = [&](int a, int b) -> std::optional<RelativePose> {
    const int low = std::min(a, b), high = std::max(a, b);
    std::vector<RelativePose>& path = paths[static_cast<std::size_t>(low)];
    if (path.empty()) path = chain.after(low, max_distance);
    const auto n = static_cast<std::size_t>(high - low);
    if (n >= path.size()) return {};
    return a <= b ? path[n] : inverse(path[n]);
  };
  std::vector<double> errors;
  for (std::size_t i = 0; i < loops.size(); ++i)
    for (std::size_t j = i + 1; j < loops.size() && loops[j].from - loops[i].from <= max_distance;
         ++j) {
      const Loop &a = loops[i], &b = loops[j];
      if (std::abs(a.to - b.to) > max_distance) continue;
      const auto start = between(a.from, b.from), end = between(a.to, b.to);
      if (!start || !end) continue;
      const double error = squaredError(a.measured * *end, *start * b.measured);
      if (!(error <= max_squared_error)) continue;
      errors.push_back(error);
      ++result.support[a.edge];
      ++result.support[b.edge];
    }
  if (!errors.empty()) {
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    result.error_scale = *middle / kChi2Median;
  }
  return result;
}

}  // namespace hyselam_pose_graph

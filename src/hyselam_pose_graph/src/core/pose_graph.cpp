#include "hyselam_pose_graph/pose_graph.hpp"

#include <Eigen/Eigenvalues>
#include <deque>
#include <string>

#include "hyselam_common/errors.hpp"

namespace hyselam_pose_graph {

namespace {

using hyselam::InputError;
using hyselam::Pose2;

struct Neighbor {
  int pose;
  int edge;
};

std::vector<std::vector<Neighbor>> neighbors(const PoseGraph& graph) {
  std::vector<std::vector<Neighbor>> list(graph.poses.size());
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const PoseEdge& edge = graph.edges[e];
    list[static_cast<std::size_t>(edge.from)].push_back({edge.to, static_cast<int>(e)});
    list[static_cast<std::size_t>(edge.to)].push_back({edge.from, static_cast<int>(e)});
  }
  return list;
}

/// Positive semidefinite up to rounding: files hold matrices with six digits.
bool isInformation(const Eigen::Matrix3d& m) {
  if (!m.allFinite()) return false;
  const double scale = m.cwiseAbs().maxCoeff();
  if ((m - m.transpose()).cwiseAbs().maxCoeff() > 1e-6 * scale) return false;
  // Nearly every matrix is positive definite by its minors, which takes no eigenvalues.
  const double minor = m(0, 0) * m(1, 1) - m(1, 0) * m(1, 0);
  const double determinant = m(2, 2) * minor - m(2, 1) * (m(0, 0) * m(2, 1) - m(1, 0) * m(2, 0)) +
                             m(2, 0) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0));
  if (m(0, 0) > 0.0 && minor > 0.0 && determinant > 0.0) return true;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(m, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -1e-6 * scale;
}

}  // namespace

void validateEdge(const PoseEdge& e, std::size_t poses, const std::string& name) {
  const int n = static_cast<int>(poses);
  const auto refuse = [&](const std::string& reason) {
    throw InputError("pose graph", name, reason);
  };
  if (e.from < 0 || e.from >= n || e.to < 0 || e.to >= n) {
    refuse("refers to a pose that does not exist");
  }
  if (e.from == e.to) refuse("connects a pose to itself");
  if (!e.measured.isFinite()) refuse("the measurement is not finite");
  if (!isInformation(e.information)) {
    refuse("the information is not a symmetric positive semidefinite matrix");
  }
}

void PoseGraph::validate() const {
  if (ids.size() != poses.size()) {
    throw InputError(
        "pose graph", "",
        std::to_string(poses.size()) + " poses have " + std::to_string(ids.size()) + " ids");
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i].isFinite()) {
      throw InputError("pose graph", "pose " + std::to_string(ids[i]), "is not finite");
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    validateEdge(edges[i], poses.size(), "edge " + std::to_string(i));
  }
}

Eigen::Vector3d edgeError(const PoseEdge& edge, const Pose2& from, const Pose2& to) {
  const Pose2 e = between(edge.measured, between(from, to));
  return {e.x, e.y, e.theta};
}

double edgeCost(const PoseEdge& edge, const std::vector<Pose2>& poses) {
  const Eigen::Vector3d e = edgeError(edge, poses[static_cast<std::size_t>(edge.from)],
                                      poses[static_cast<std::size_t>(edge.to)]);
  return e.dot(edge.information * e);
}

double graphCost(const PoseGraph& graph, const std::vector<Pose2>& poses) {
  double sum = 0.0;
  for (const PoseEdge& edge : graph.edges) sum += edgeCost(edge, poses);
  return sum;
}

std::vector<Pose2> composedPoses(const PoseGraph& graph) {
  const auto list = neighbors(graph);
  std::vector<Pose2> poses = graph.poses;
  std::vector<char> known(poses.size(), 0);
  std::deque<std::size_t> queue;
  const auto place = [&](std::size_t at, const Neighbor& n) {
    const PoseEdge& edge = graph.edges[static_cast<std::size_t>(n.edge)];
    const auto next = static_cast<std::size_t>(n.pose);
    const bool forward = static_cast<std::size_t>(edge.from) == at;
    poses[next] = poses[at] * (forward ? edge.measured : edge.measured.inverse());
    known[next] = 1;
    queue.push_back(next);
  };
  // Along odometry from `at`, as far as it goes without a gap.
  const auto followOdometry = [&](std::size_t at) {
    for (bool moved = true; moved;) {
      moved = false;
      for (const Neighbor& n : list[at]) {
        if (n.pose != static_cast<int>(at) + 1 || known[at + 1]) continue;
        place(at, n);
        ++at;
        moved = true;
        break;
      }
    }
  };
  for (std::size_t first = 0; first < poses.size(); ++first) {
    if (known[first]) continue;
    known[first] = 1;
    queue.push_back(first);
    followOdometry(first);
    while (!queue.empty()) {
      const std::size_t at = queue.front();
      queue.pop_front();
      for (const Neighbor& n : list[at]) {
        if (known[static_cast<std::size_t>(n.pose)]) continue;
        place(at, n);
        followOdometry(static_cast<std::size_t>(n.pose));
      }
    }
  }
  return poses;
}

std::vector<int> connectedComponents(const PoseGraph& graph) {
  // A forest in which every pose points to an earlier one of its component, or to itself.
  std::vector<int> earlier(graph.poses.size());
  for (std::size_t i = 0; i < earlier.size(); ++i) earlier[i] = static_cast<int>(i);
  const auto first = [&](int pose) {
    for (;;) {
      int& up = earlier[static_cast<std::size_t>(pose)];
      if (up == pose) return pose;
      up = earlier[static_cast<std::size_t>(up)];  // halves the way for the next one
      pose = up;
    }
  };
  for (const PoseEdge& edge : graph.edges) {
    const int a = first(edge.from), b = first(edge.to);
    earlier[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::vector<int> component(graph.poses.size());
  int components = 0;
  for (std::size_t i = 0; i < component.size(); ++i) {
    const auto up = static_cast<std::size_t>(earlier[i]);
    component[i] = up == i ? components++ : component[up];
  }
  return component;
}

}  // namespace hyselam_pose_graph

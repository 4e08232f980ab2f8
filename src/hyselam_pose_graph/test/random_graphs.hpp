// Pose graphs with a known truth, from seeds.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "hyselam_pose_graph/pose_graph.hpp"

namespace random_graphs {

struct Known {
  hyselam_pose_graph::PoseGraph graph;  ///< poses composed along noisy odometry
  std::vector<hyselam::Pose2> truth;
};

inline double noise(hyselam::Rng* rng, double sigma) {
  return sigma * (rng->uniform() + rng->uniform() + rng->uniform() - 1.5) * 2.0;
}

inline hyselam_pose_graph::PoseEdge measured(int from, int to,
                                             const std::vector<hyselam::Pose2>& truth, double sigma,
                                             hyselam::Rng* rng) {
  hyselam_pose_graph::PoseEdge e;
  e.from = from;
  e.to = to;
  const hyselam::Pose2 exact =
      between(truth[static_cast<std::size_t>(from)], truth[static_cast<std::size_t>(to)]);
  e.measured = exact * hyselam::Pose2{noise(rng, sigma), noise(rng, sigma), noise(rng, sigma)};
  const double w = sigma > 0.0 ? 1.0 / (sigma * sigma) : 1e4;
  e.information = Eigen::Vector3d(w, w, w).asDiagonal();
  e.information(0, 1) = e.information(1, 0) = 0.2 * w;
  return e;
}

/// The largest difference between two poses of one number [m or rad].
inline double worst(const std::vector<hyselam::Pose2>& a, const std::vector<hyselam::Pose2>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(
        {worst, distance(a[i], b[i]), std::abs(hyselam::normalizeAngle(a[i].theta - b[i].theta))});
  return worst;
}

/// A walk over streets a metre apart, with a loop wherever it comes back to a crossing.
inline Known streets(int poses, double sigma, std::uint64_t seed) {
  hyselam::Rng rng(seed);
  Known k;
  hyselam::Pose2 at;
  for (int i = 0; i < poses; ++i) {
    k.graph.ids.push_back(i);
    k.truth.push_back(at);
    const double turn = rng.uniform() < 0.3 ? (rng.uniform() < 0.5 ? 1.0 : -1.0) : 0.0;
    at = at * hyselam::Pose2{0.0, 0.0, turn * hyselam::kPi / 2.0} * hyselam::Pose2{1.0, 0.0, 0.0};
  }
  for (int i = 1; i < poses; ++i) {
    k.graph.edges.push_back(measured(i - 1, i, k.truth, sigma, &rng));
    for (int j = 0; j + 5 < i; ++j)
      if (distance(k.truth[static_cast<std::size_t>(i)], k.truth[static_cast<std::size_t>(j)]) <
          0.5) {
        k.graph.edges.push_back(measured(j, i, k.truth, sigma, &rng));
        break;
      }
  }
  k.graph.poses.assign(static_cast<std::size_t>(poses), hyselam::Pose2{});
  k.graph.poses = composedPoses(k.graph);
  return k;
}

/// Leaves loops out until those that stay end at least `every` poses apart.
inline void thinLoops(hyselam_pose_graph::PoseGraph* graph, int every) {
  std::vector<hyselam_pose_graph::PoseEdge> kept;
  int last = -every;
  for (const hyselam_pose_graph::PoseEdge& e : graph->edges) {
    if (!isOdometry(e)) {
      if (e.to - last < every) continue;
      last = e.to;
    }
    kept.push_back(e);
  }
  graph->edges = kept;
}

}  // namespace random_graphs

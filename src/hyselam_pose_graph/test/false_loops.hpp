// Graphs that lie, from seeds, and how far poses are off.
#pragma once

#include <complex>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "hyselam_pose_graph/pose_graph.hpp"

namespace false_loops {

/// Adds `share` times as many false loops as the graph has loops: poses at random, more than ten
/// apart in the list, measurement and information each of some true loop, so that nothing but
/// contradiction tells them apart. They come last.
inline void add(hyselam_pose_graph::PoseGraph* graph, double share, std::uint64_t seed) {
  hyselam::Rng rng(seed);
  std::vector<hyselam_pose_graph::PoseEdge> loops;
  for (const auto& e : graph->edges)
    if (!isOdometry(e)) loops.push_back(e);
  const auto any = [&](std::size_t n) { return rng.below(static_cast<std::uint32_t>(n)); };
  const auto count = static_cast<std::size_t>(share * static_cast<double>(loops.size()));
  for (std::size_t k = 0; k < count; ++k) {
    hyselam_pose_graph::PoseEdge e = loops[any(loops.size())];
    e.measured = loops[any(loops.size())].measured;
    do {
      e.from = static_cast<int>(any(graph->poses.size()));
      e.to = static_cast<int>(any(graph->poses.size()));
    } while (std::abs(e.from - e.to) <= 10);
    graph->edges.push_back(e);
  }
}

/// Root mean square distance of positions after the best rigid motion onto the reference [m].
inline double trajectoryError(const std::vector<hyselam::Pose2>& poses,
                              const std::vector<hyselam::Pose2>& reference) {
  using Complex = std::complex<double>;
  const auto n = static_cast<double>(poses.size());
  Complex mean, reference_mean, turn;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    mean += Complex{poses[i].x, poses[i].y} / n;
    reference_mean += Complex{reference[i].x, reference[i].y} / n;
  }
  for (std::size_t i = 0; i < poses.size(); ++i)
    turn += std::conj(Complex{poses[i].x, poses[i].y} - mean) *
            (Complex{reference[i].x, reference[i].y} - reference_mean);
  turn = std::abs(turn) > 0.0 ? turn / std::abs(turn) : Complex{1.0, 0.0};
  double sum = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    sum += std::norm(turn * (Complex{poses[i].x, poses[i].y} - mean) -
                     (Complex{reference[i].x, reference[i].y} - reference_mean));
  return std::sqrt(sum / n);
}

/// The way of a robot that moves by metres and turns by right angles, as M3500's does: odometry
/// rounded to that.
inline std::vector<hyselam::Pose2> manhattanTruth(hyselam_pose_graph::PoseGraph graph) {
  std::vector<hyselam_pose_graph::PoseEdge> odometry;
  for (hyselam_pose_graph::PoseEdge e : graph.edges) {
    if (!isOdometry(e)) continue;
    e.measured.x = std::round(e.measured.x);
    e.measured.y = std::round(e.measured.y);
    e.measured.theta = std::round(e.measured.theta / (hyselam::kPi / 2.0)) * hyselam::kPi / 2.0;
    odometry.push_back(e);
  }
  graph.edges = odometry;
  graph.poses.front() = {};
  return composedPoses(graph);
}

}  // namespace false_loops

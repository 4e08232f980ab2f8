// A robot drives round a square of 2 m. Its odometry turns 2 degrees too far at each corner; a loop
// closure with the start corrects the drift.
#include <cmath>
#include <cstdio>

#include "hyselam_pose_graph/incremental_graph.hpp"

int main() {
  hyselam_pose_graph::IncrementalGraph graph;
  graph.addPose({0.0, 0.0, 0.0});
  for (int side = 0; side < 4; ++side) {
    graph.append({2.0, 0.0, hyselam::radians(92.0)}, Eigen::Matrix3d::Identity());
  }
  hyselam_pose_graph::PoseEdge loop;
  loop.from = 0;
  loop.to = 4;  // seen again, at the same pose as pose 0
  loop.information = 100.0 * Eigen::Matrix3d::Identity();
  graph.addEdge(loop);

  const auto result = graph.optimize();
  std::printf("cost %.3f -> %.3f\n", result.initial_cost, result.final_cost);
  for (const hyselam::Pose2& p : graph.graph().poses) {
    std::printf("%ld cm  %ld cm  %ld deg\n", std::lround(100.0 * p.x), std::lround(100.0 * p.y),
                (std::lround(hyselam::degrees(p.theta)) + 360) % 360);
  }
  return 0;
}

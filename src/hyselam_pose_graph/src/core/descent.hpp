// Iterative minimization of a pose graph's cost.
#pragma once

#include <vector>

#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "pose_system.hpp"

namespace hyselam_pose_graph {

class Descent {
 public:
  using Poses = std::vector<SystemPose>;

  Descent(const PoseSystem& system, const OptimizeParams& params)
      : system_(system), params_(params), h_(system.pattern()) {}

  /// Of each edge, 0..1; empty: all 1.
  std::vector<double> weights;
  /// Linear systems solved.
  int iterations() const { return iterations_; }

  /// Positions, and small corrections of the rotations, that fit the rotations best: one linear
  /// system. False if the edges do not determine them.
  bool solvePositions(Poses* poses);
  /// Rotations by the chordal relaxation, then positions by solvePositions(). False, and `poses`
  /// unchanged, if the edges do not determine them.
  bool initializeChordal(Poses* poses);
  /// Descends at most `steps` steps, each followed near the minimum by up to two by the factor
  /// before. True when the tolerance was reached.
  bool descend(Poses* poses, int steps);

  /// Factorizes the information at `poses` for innovation(). False if the edges do not determine
  /// them.
  bool factorAt(const Poses& poses);
  /// Squared Mahalanobis error of an edge that is not in the graph, with its own covariance and the
  /// graph's covariance between its poses: chi^2 with three degrees of freedom if it is true.
  double innovation(const SystemEdge& edge, const Poses& poses) const;

 private:
  bool step(const Poses& poses, double damping, double* predicted);
  bool takeFullSteps(Poses* poses, int steps);
  double solve();
  bool finish(int steps, double* cost, Poses* poses);

  const PoseSystem& system_;
  const OptimizeParams& params_;
  BlockCholesky<Block3> h_;
  std::vector<PoseSystem::Vector> b_, gradient_;
  int iterations_ = 0;
};

}  // namespace hyselam_pose_graph

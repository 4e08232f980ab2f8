// Poses on their way to a minimum of a pose graph's cost.
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

  /// Of each edge, 0..1; none: all 1.
  std::vector<double> weights;
  /// Linear systems of poses solved.
  int iterations() const { return iterations_; }

  /// Positions, and small turns, that fit the rotations best: one linear system. False if the edges
  /// do not determine them.
  bool placeByRotations(Poses* poses);
  /// Rotations by the chordal relaxation, positions by the above. False and unchanged as above.
  bool relax(Poses* poses);
  /// Descends at most `steps` steps. True when the tolerance was reached.
  bool descend(Poses* poses, int steps);

  /// Takes `poses` for the minimum: what innovation() is judged at. False if the edges do not
  /// determine them.
  bool judgeAt(const Poses& poses);
  /// The squared error of an edge that is not in the graph, by its own information and by what the
  /// graph leaves open between its two poses: chi^2 with three degrees of freedom if it is true.
  double innovation(const SystemEdge& edge, const Poses& poses) const;

 private:
  bool step(const Poses& poses, double damping, double* promised);
  bool leap(Poses* poses, int steps);

  const PoseSystem& system_;
  const OptimizeParams& params_;
  BlockCholesky<Block3> h_;
  std::vector<PoseSystem::Vector> b_, gradient_;
  int iterations_ = 0;
};

}  // namespace hyselam_pose_graph

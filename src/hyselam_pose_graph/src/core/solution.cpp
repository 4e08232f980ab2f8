#include "solution.hpp"

#include <algorithm>
#include <cmath>

#include "descent.hpp"
#include "lifted_rotations.hpp"
#include "robust_weights.hpp"

namespace hyselam_pose_graph {

namespace {

using Poses = Descent::Poses;

constexpr int kStepsBeforeRelaxation = 20;  // enough for a good start
// Near the minimum of the relaxation is near enough, if all edges fit at the minimum from there:
// the last steps are the most. Looked at on M3500c.
constexpr double kLiftedTolerances[] = {3e-3, 1e-4, 1e-8};

/// Dynamic covariance scaling: each step with the weights given by the errors before it.
bool descendDcs(const PoseGraph& graph, const PoseSystem& system, const OptimizeParams& params,
                Descent* descent, Poses* poses) {
  descent->weights.assign(graph.edges.size(), 1.0);
  std::vector<double> squared;
  double before = -1.0;
  while (descent->iterations() < params.max_iterations) {
    system.edgeCosts(*poses, &squared);
    double cost = 0.0;
    for (std::size_t k = 0; k < squared.size(); ++k) {
      double& weight = descent->weights[k];
      if (!isOdometry(graph.edges[k])) weight = dcsWeight(squared[k], params.dcs_phi);
      const double s = std::sqrt(weight);
      cost += weight * squared[k] + params.dcs_phi * (1.0 - s) * (1.0 - s);
    }
    if (before >= 0.0 && std::abs(before - cost) <= params.tolerance * cost) return true;
    before = cost;
    descent->descend(poses, 1);
  }
  return false;
}

/// Whether poses are a start: on average the edges fit there as they say, with three degrees of
/// freedom each, and none is turned too far.
bool fit(const Descent::Poses& poses, const PoseSystem& system, const OptimizeParams& params) {
  return system.cost(poses, {}) <= 3.0 * static_cast<double>(system.edges().size()) &&
         system.maxRotationError(poses) <= params.max_rotation_error;
}

}  // namespace

OptimizeResult solveGraph(const PoseGraph& graph, const PoseSystem& system,
                          const OptimizeParams& params, const std::vector<hyselam::Pose2>& given) {
  OptimizeResult result;
  Descent descent(system, params);
  Poses poses = PoseSystem::system(given);
  // False loops mislead the chordal relaxation: DCS starts with odometry.
  const bool composed = params.start == GraphStart::kComposed ||
                        (params.robust == GraphRobust::kDcs && params.start == GraphStart::kBest);
  const bool stay = params.start == GraphStart::kGiven ||
                    (params.start == GraphStart::kBest && !composed && fit(poses, system, params));
  if (composed || (!stay && !descent.initializeChordal(&poses)))
    poses = PoseSystem::system(composedPoses(graph));
  if (params.robust == GraphRobust::kDcs) {
    result.converged = descendDcs(graph, system, params, &descent, &poses);
  } else if (params.start != GraphStart::kBest) {
    result.converged = descent.descend(&poses, params.max_iterations);
  } else {
    result.converged =
        descent.descend(&poses, std::min(kStepsBeforeRelaxation, params.max_iterations));
    if (system.maxRotationError(poses) > params.max_rotation_error) {
      LiftedRotations lifted(system, poses);
      for (const double tolerance : kLiftedTolerances) {
        if (!lifted.descend(tolerance)) break;
        Poses other = lifted.poses();
        if (!descent.solvePositions(&other)) continue;
        const bool converged = descent.descend(&other, params.max_iterations);
        if (system.cost(other, {}) < system.cost(poses, {})) {
          poses = std::move(other);
          result.converged = converged;
          result.global = true;
        }
        if (system.maxRotationError(poses) <= params.max_rotation_error) break;
      }
    }
    if (!result.converged) result.converged = descent.descend(&poses, params.max_iterations);
  }
  result.poses = PoseSystem::poses(poses);
  result.iterations = descent.iterations();
  result.weights = descent.weights;
  return result;
}

}  // namespace hyselam_pose_graph

#include "hyselam_pose_graph/graph_optimizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "descent.hpp"
#include "gnc.hpp"
#include "hyselam_common/errors.hpp"
#include "lifted_rotations.hpp"
#include "marginals.hpp"
#include "pose_system.hpp"
#include "robust_weights.hpp"

namespace hyselam_pose_graph {

namespace {

using Poses = Descent::Poses;
using hyselam::ParameterError;

constexpr int kStepsBeforeDoubt = 20;  // a good start needs fewer

/// Dynamic covariance scaling: each step with the weights that the last one's errors give.
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

OptimizeResult solve(const PoseGraph& graph, const PoseSystem& system,
                     const OptimizeParams& params) {
  OptimizeResult result;
  Descent descent(system, params);
  Poses poses = PoseSystem::system(graph.poses);
  // Loops of unknown truth mislead the relaxation: DCS starts with odometry.
  const bool composed = params.start == GraphStart::kComposed ||
                        (params.robust == GraphRobust::kDcs && params.start == GraphStart::kBest);
  if (composed || (params.start != GraphStart::kGiven && !descent.relax(&poses)))
    poses = PoseSystem::system(composedPoses(graph));
  if (params.robust == GraphRobust::kDcs) {
    result.converged = descendDcs(graph, system, params, &descent, &poses);
  } else if (params.start != GraphStart::kBest) {
    result.converged = descent.descend(&poses, params.max_iterations);
  } else {
    result.converged = descent.descend(&poses, std::min(kStepsBeforeDoubt, params.max_iterations));
    if (system.largestTurn(poses) > params.doubtful_turn) {
      Poses other = liftedSolution(system, poses);
      if (descent.placeByRotations(&other)) {
        const bool converged = descent.descend(&other, params.max_iterations);
        if (system.cost(other, {}) < system.cost(poses, {})) {
          poses = std::move(other);
          result.converged = converged;
          result.global = true;
        }
      }
    }
    if (!result.converged) result.converged = descent.descend(&poses, params.max_iterations);
  }
  result.poses = PoseSystem::poses(poses);
  result.iterations = descent.iterations();
  result.weights = descent.weights;
  return result;
}

}  // namespace

void OptimizeParams::validate() const {
  if (max_iterations < 1) throw ParameterError("max_iterations", max_iterations, "at least 1");
  if (!(tolerance > 0.0 && tolerance < 1.0))
    throw ParameterError("tolerance", tolerance, "between 0 and 1");
  if (!(dcs_phi > 0.0)) throw ParameterError("dcs_phi", dcs_phi, "above 0");
  if (!(gnc_inlier > 0.0)) throw ParameterError("gnc_inlier", gnc_inlier, "above 0");
  if (!(doubtful_turn > 0.0)) throw ParameterError("doubtful_turn", doubtful_turn, "above 0");
}

GraphOptimizer::GraphOptimizer(PoseGraph graph) : graph_(std::move(graph)) {
  graph_.validate();
  system_ = std::make_unique<PoseSystem>(graph_);
}
GraphOptimizer::GraphOptimizer(PoseGraph graph, const GraphOptimizer& earlier)
    : graph_(std::move(graph)) {
  graph_.validate();
  system_ = std::make_unique<PoseSystem>(graph_, earlier.system_.get());
}
GraphOptimizer::~GraphOptimizer() = default;
GraphOptimizer::GraphOptimizer(GraphOptimizer&&) noexcept = default;
GraphOptimizer& GraphOptimizer::operator=(GraphOptimizer&&) noexcept = default;

bool GraphOptimizer::reusesPattern() const {
  return system_->reusesPattern();
}

OptimizeResult GraphOptimizer::optimize(const OptimizeParams& params) const {
  params.validate();
  OptimizeResult result = params.robust == GraphRobust::kGnc ? solveGnc(graph_, *system_, params)
                                                             : solve(graph_, *system_, params);
  result.initial_cost = graphCost(graph_, graph_.poses);
  result.final_cost = graphCost(graph_, result.poses);
  return result;
}

std::vector<Eigen::Matrix3d> GraphOptimizer::covariances(const std::vector<hyselam::Pose2>& poses,
                                                         const std::vector<int>& of,
                                                         const std::vector<double>& weights) const {
  if (poses.size() != graph_.poses.size())
    throw std::invalid_argument("covariances: as many poses as the graph has, please");
  if (!weights.empty() && weights.size() != graph_.edges.size())
    throw std::invalid_argument("covariances: as many weights as the graph has edges, please");
  const Marginals marginals(*system_, poses, weights);
  std::vector<Eigen::Matrix3d> result;
  result.reserve(of.size());
  for (const int pose : of) result.push_back(marginals.covariance(pose));
  return result;
}

}  // namespace hyselam_pose_graph

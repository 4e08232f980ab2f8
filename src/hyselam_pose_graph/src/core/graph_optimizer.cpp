#include "hyselam_pose_graph/graph_optimizer.hpp"

#include <algorithm>
#include <cmath>

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
using hyselam::InputError;
using hyselam::Range;

constexpr int kStepsBeforeRelaxation = 20;  // enough for a good start

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

OptimizeResult solve(const PoseGraph& graph, const PoseSystem& system,
                     const OptimizeParams& params) {
  OptimizeResult result;
  Descent descent(system, params);
  Poses poses = PoseSystem::system(graph.poses);
  // False loops mislead the chordal relaxation: DCS starts with odometry.
  const bool composed = params.start == GraphStart::kComposed ||
                        (params.robust == GraphRobust::kDcs && params.start == GraphStart::kBest);
  if (composed || (params.start != GraphStart::kGiven && !descent.initializeChordal(&poses)))
    poses = PoseSystem::system(composedPoses(graph));
  if (params.robust == GraphRobust::kDcs) {
    result.converged = descendDcs(graph, system, params, &descent, &poses);
  } else if (params.start != GraphStart::kBest) {
    result.converged = descent.descend(&poses, params.max_iterations);
  } else {
    result.converged =
        descent.descend(&poses, std::min(kStepsBeforeRelaxation, params.max_iterations));
    if (system.maxRotationError(poses) > params.max_rotation_error) {
      Poses other = solveLifted(system, poses);
      if (descent.solvePositions(&other)) {
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

void OptimizeParams::describe(hyselam::ParameterVisitor& visit) {
  visit("start", start,
        {{"given", GraphStart::kGiven},
         {"composed", GraphStart::kComposed},
         {"chordal", GraphStart::kChordal},
         {"best", GraphStart::kBest}},
        "initial poses");
  visit("method", method,
        {{"gauss-newton", GraphMethod::kGaussNewton},
         {"levenberg-marquardt", GraphMethod::kLevenbergMarquardt}},
        "steps of the descent");
  visit("robust", robust,
        {{"none", GraphRobust::kNone}, {"dcs", GraphRobust::kDcs}, {"gnc", GraphRobust::kGnc}},
        "how false loops are rejected");
  visit("max_iterations", max_iterations, Range::atLeast(1), "", "linear systems solved at most");
  visit("tolerance", tolerance, Range::inside(0.0, 1.0), "",
        "stop below this predicted relative decrease of the cost");
  visit("dcs_phi", dcs_phi, Range::above(0.0), "",
        "squared error above which DCS reduces the weight");
  visit("gnc_inlier_threshold", gnc_inlier_threshold, Range::above(0.0), "",
        "squared error that a true edge stays below");
  visit("max_rotation_error", max_rotation_error, Range::above(0.0), "rad",
        "rotation error at the minimum above which the global relaxation starts");
}

void OptimizeParams::validate() const {
  hyselam::checkParameters(*this);
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
    throw InputError("covariances", "poses", "are not as many as the graph has");
  if (!weights.empty() && weights.size() != graph_.edges.size())
    throw InputError("covariances", "weights", "are not as many as the graph has edges");
  const Marginals marginals(*system_, poses, weights);
  std::vector<Eigen::Matrix3d> result;
  result.reserve(of.size());
  for (const int pose : of) result.push_back(marginals.covariance(pose));
  return result;
}

}  // namespace hyselam_pose_graph

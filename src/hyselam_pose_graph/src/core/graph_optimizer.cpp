#include "hyselam_pose_graph/graph_optimizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hyselam_common/errors.hpp"
#include "lifted_rotations.hpp"
#include "pose_system.hpp"
#include "robust_weights.hpp"

namespace hyselam_pose_graph {

namespace {

using Poses = std::vector<SystemPose>;
using hyselam::ParameterError;

constexpr double kGncGrowth = 1.4;     // of mu per round, as its authors have it
constexpr int kStepsBeforeDoubt = 20;  // a good start needs fewer

/// One optimisation: poses on their way to the minimum.
class Descent {
 public:
  Descent(const PoseGraph& graph, const PoseSystem& system, const OptimizeParams& params)
      : graph_(graph), system_(system), params_(params), h_(system.pattern()) {}

  OptimizeResult run() {
    OptimizeResult result;
    result.initial_cost = graphCost(graph_, graph_.poses);
    Poses poses = start();
    switch (params_.robust) {
      case GraphRobust::kNone:
        result.converged =
            descend(&poses, params_.start == GraphStart::kBest ? kStepsBeforeDoubt
                                                               : params_.max_iterations);
        break;
      case GraphRobust::kDcs:
        result.converged = descendDcs(&poses);
        break;
      case GraphRobust::kGnc:
        result.converged = descendGnc(&poses);
        break;
    }
    if (params_.start == GraphStart::kBest && params_.robust == GraphRobust::kNone) {
      if (system_.largestTurn(poses) > params_.doubtful_turn) tryGlobal(&poses, &result);
      if (!result.converged) result.converged = descend(&poses, params_.max_iterations);
    }
    result.poses = PoseSystem::poses(poses);
    result.final_cost = system_.cost(poses, {});
    result.iterations = iterations_;
    result.weights = weights_;
    return result;
  }

 private:
  bool spent() const { return iterations_ >= params_.max_iterations; }

  Poses start() {
    const GraphStart from = params_.start;
    if (from == GraphStart::kGiven) return PoseSystem::system(graph_.poses);
    if (from == GraphStart::kComposed) return PoseSystem::system(composedPoses(graph_));
    Poses poses = PoseSystem::system(graph_.poses);
    if (!system_.chordalRotations({}, &poses) || !placeByRotations(&poses))
      return PoseSystem::system(composedPoses(graph_));
    return poses;
  }

  /// Positions, and small turns, by one linear system. False if it cannot be solved.
  bool placeByRotations(Poses* poses) {
    for (std::size_t i = 0; i < poses->size(); ++i)
      if (system_.row(static_cast<int>(i)) >= 0) (*poses)[i].x = (*poses)[i].y = 0.0;
    system_.lineariseFromRotations(*poses, weights_, &h_, &b_);
    ++iterations_;
    if (!factorPoses(&h_)) return false;
    h_.solve(&b_);
    *poses = system_.moved(*poses, b_);
    return true;
  }

  /// The step at `poses` with the weights as they are, in b_. False if there is none. Tells what
  /// the step promises to take from the cost.
  bool step(const Poses& poses, double damping, double* promised) {
    system_.linearise(poses, weights_, damping, &h_, &b_);
    ++iterations_;
    if (!factorPoses(&h_)) return false;
    gradient_ = b_;
    h_.solve(&b_);
    double sum = 0.0;
    for (std::size_t i = 0; i < b_.size(); ++i) {
      const PoseSystem::Vector p = b_[i] * gradient_[i];
      sum += p[0] + p[1] + p[2];
    }
    *promised = sum;
    return std::isfinite(sum);
  }

  /// Descends with weights that stay. True when the tolerance was reached.
  bool descend(Poses* poses, int steps) {
    double cost = system_.cost(*poses, weights_), damping = 0.0;
    for (int done = 0; done < steps && !spent(); ++done) {
      double promised = 0.0;
      const bool found = step(*poses, damping, &promised);
      const bool damped = params_.method == GraphMethod::kLevenbergMarquardt;
      if (!found && !damped) return false;
      if (found) {
        Poses next = system_.moved(*poses, b_);
        const double next_cost = system_.cost(next, weights_);
        // Rounding may lift the cost a little at the very minimum.
        const bool settled = promised <= params_.tolerance * cost;
        if (!damped || next_cost <= cost || (settled && next_cost <= cost * (1.0 + 1e-9))) {
          *poses = std::move(next);
          cost = next_cost;
          if (settled && damping <= 1e-3) return true;
          damping = damping > 1e-6 ? damping / 10.0 : 0.0;
          continue;
        }
        if (settled && damping > 1e6) return true;
      }
      damping = damping > 0.0 ? damping * 10.0 : 1e-4;
      if (damping > 1e12) return false;
    }
    return false;
  }

  bool descendDcs(Poses* poses) {
    weights_.assign(graph_.edges.size(), 1.0);
    std::vector<double> squared;
    double before = -1.0;
    while (!spent()) {
      system_.edgeCosts(*poses, &squared);
      double cost = 0.0;
      for (std::size_t k = 0; k < squared.size(); ++k) {
        if (!isOdometry(graph_.edges[k])) weights_[k] = dcsWeight(squared[k], params_.dcs_phi);
        const double s = std::sqrt(weights_[k]);
        cost += weights_[k] * squared[k] + params_.dcs_phi * (1.0 - s) * (1.0 - s);
      }
      if (before >= 0.0 && std::abs(before - cost) <= params_.tolerance * cost) return true;
      before = cost;
      descend(poses, 1);
    }
    return false;
  }

  bool descendGnc(Poses* poses) {
    weights_.assign(graph_.edges.size(), 1.0);
    descend(poses, params_.max_iterations);
    std::vector<double> squared;
    system_.edgeCosts(*poses, &squared);
    double largest = 0.0;
    for (std::size_t k = 0; k < squared.size(); ++k)
      if (!isOdometry(graph_.edges[k])) largest = std::max(largest, squared[k]);
    double mu = gncFirstMu(largest, params_.gnc_inlier);
    if (mu <= 0.0) return true;  // nothing contradicts
    for (bool last = false; !spent();) {
      last = true;
      system_.edgeCosts(*poses, &squared);
      for (std::size_t k = 0; k < squared.size(); ++k) {
        if (isOdometry(graph_.edges[k])) continue;
        weights_[k] = gncWeight(squared[k], params_.gnc_inlier, mu);
        last = last && (weights_[k] == 0.0 || weights_[k] == 1.0);
      }
      const bool settled = descend(poses, last ? params_.max_iterations : 3);
      if (last && mu > 1.0) return settled;
      mu *= kGncGrowth;
    }
    return false;
  }

  void tryGlobal(Poses* poses, OptimizeResult* result) {
    Poses other = liftedSolution(system_, *poses);
    iterations_ = 0;
    if (!placeByRotations(&other)) return;
    const bool converged = descend(&other, params_.max_iterations);
    if (!(system_.cost(other, {}) < system_.cost(*poses, {}))) return;
    *poses = std::move(other);
    result->converged = converged;
    result->global = true;
  }

  const PoseGraph& graph_;
  const PoseSystem& system_;
  const OptimizeParams& params_;
  BlockCholesky<Block3> h_;
  std::vector<PoseSystem::Vector> b_, gradient_;
  std::vector<double> weights_;
  int iterations_ = 0;
};

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
GraphOptimizer::~GraphOptimizer() = default;
GraphOptimizer::GraphOptimizer(GraphOptimizer&&) noexcept = default;
GraphOptimizer& GraphOptimizer::operator=(GraphOptimizer&&) noexcept = default;

OptimizeResult GraphOptimizer::optimize(const OptimizeParams& params) const {
  params.validate();
  return Descent(graph_, *system_, params).run();
}

std::vector<Eigen::Matrix3d> GraphOptimizer::covariances(const std::vector<hyselam::Pose2>& poses,
                                                         const std::vector<int>& of) const {
  if (poses.size() != graph_.poses.size())
    throw std::invalid_argument("covariances: as many poses as the graph has, please");
  BlockCholesky<Block3> h(system_->pattern());
  std::vector<PoseSystem::Vector> b;
  system_->linearise(PoseSystem::system(poses), {}, 0.0, &h, &b);
  if (!factorPoses(&h)) throw std::runtime_error("the edges do not determine the poses");
  std::vector<Eigen::Matrix3d> result;
  for (const int pose : of) {
    if (pose < 0 || pose >= static_cast<int>(poses.size()))
      throw std::invalid_argument("covariances: no pose " + std::to_string(pose));
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    const int row = system_->row(pose);
    for (int k = 0; k < 3 && row >= 0; ++k) {
      std::vector<PoseSystem::Vector> unit(static_cast<std::size_t>(system_->rows()));
      std::fill(unit.begin(), unit.end(), PoseSystem::Vector{});
      unit[static_cast<std::size_t>(row)][k] = 1.0;
      h.solve(&unit);
      for (int r = 0; r < 3; ++r) covariance(r, k) = unit[static_cast<std::size_t>(row)][r];
    }
    result.push_back(covariance);
  }
  return result;
}

}  // namespace hyselam_pose_graph

#include "robust_solution.hpp"

#include <algorithm>
#include <cmath>

#include "gnc.hpp"
#include "solution.hpp"

namespace hyselam_pose_graph {

namespace {

/// How many times the variance that the edges state their errors may have before the odometry
/// counts as worse than it says.
constexpr double kHonestScale = 2.0;

std::size_t agreeingEdges(const OptimizeResult& result) {
  return static_cast<std::size_t>(
      std::count_if(result.weights.begin(), result.weights.end(),
                    [](double weight) { return weight >= kAgreeingWeight; }));
}

/// How well the edges that agree fit one another.
struct Fit {
  int agreeing_loops = 0, rejected_loops = 0;
  /// Variance of the errors, in units of the stated one; at least 1.
  double scale = 1.0;
  /// Twice the negative log-likelihood of the result, up to a constant, with that scale: each loop
  /// that agrees leaves three degrees of freedom, each one that does not costs the squared error
  /// that a true one may have. So a few loops are given up sooner than the odometry, and the
  /// odometry sooner than most loops.
  double score = 0.0;
};

Fit fitOf(const PoseGraph& graph, const OptimizeResult& result, double rejected_cost) {
  Fit fit;
  double squares = 0.0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const bool agrees = result.weights[k] >= kAgreeingWeight;
    if (!isOdometry(graph.edges[k])) ++(agrees ? fit.agreeing_loops : fit.rejected_loops);
    if (agrees) squares += edgeCost(graph.edges[k], result.poses);
  }
  const double freedom = 3.0 * fit.agreeing_loops;
  if (freedom > 0.0) fit.scale = std::max(1.0, squares / freedom);
  fit.score =
      squares / fit.scale + freedom * std::log(fit.scale) + rejected_cost * fit.rejected_loops;
  return fit;
}

/// `p.robust` from `poses`.
OptimizeResult solveFrom(const std::vector<hyselam::Pose2>& poses, const PoseGraph& graph,
                         const PoseSystem& system, OptimizeParams p) {
  p.start = GraphStart::kGiven;
  const bool gnc = p.robust == GraphRobust::kGnc;
  if (gnc) p.robust = GraphRobust::kDcs;
  OptimizeResult result = solveGraph(graph, system, p, poses);
  if (!gnc) return result;
  OptimizeResult other = solveGncFrom(result, graph, system, p);
  other.iterations += result.iterations;
  return other;
}

/// From the poses at which all loops have full weight: a loop that closes after hundreds of meters
/// looks wrong from odometry, however right it is.
OptimizeResult solveFromAllLoops(const PoseGraph& graph, const PoseSystem& system,
                                 const OptimizeParams& params) {
  OptimizeParams p = params;
  p.robust = GraphRobust::kNone;
  p.start = GraphStart::kChordal;
  const OptimizeResult all = solveGraph(graph, system, p, graph.poses);
  OptimizeResult result = solveFrom(all.poses, graph, system, params);
  result.iterations += all.iterations;
  result.followed_all = true;
  return result;
}

/// From the poses that loops agree on which confirm one another.
OptimizeResult solveFromConsistentLoops(const PoseGraph& graph, const PoseSystem& system,
                                        const OptimizeParams& params) {
  const OptimizeResult consistent = solveGnc(graph, system, params);
  OptimizeResult result = solveFrom(consistent.poses, graph, system, params);
  result.iterations += consistent.iterations;
  return result;
}

class BestOfStarts {
 public:
  BestOfStarts(const PoseGraph& graph, const OptimizeParams& params, OptimizeResult first)
      : graph_(graph), params_(params), best_(std::move(first)), fit_(fitOf(best_)) {}
  void offer(OptimizeResult other) {
    const int iterations = best_.iterations + other.iterations;
    const Fit fit = fitOf(other);
    if (fit.score < fit_.score) {
      best_ = std::move(other);
      fit_ = fit;
    }
    best_.iterations = iterations;
  }
  const Fit& fit() const { return fit_; }
  OptimizeResult take() { return std::move(best_); }

 private:
  Fit fitOf(const OptimizeResult& result) const {
    return hyselam_pose_graph::fitOf(graph_, result, params_.gnc_inlier_threshold);
  }
  const PoseGraph& graph_;
  const OptimizeParams& params_;
  OptimizeResult best_;
  Fit fit_;
};

}  // namespace

OptimizeResult solveRobust(const PoseGraph& graph, const PoseSystem& system,
                           const OptimizeParams& params) {
  const bool gnc = params.robust == GraphRobust::kGnc;
  OptimizeResult result =
      gnc ? solveGnc(graph, system, params) : solveGraph(graph, system, params, graph.poses);
  const bool done =
      params.follow == FollowLoops::kNone || agreeingEdges(result) == graph.edges.size();
  if (!done && params.follow == FollowLoops::kAll) {
    OptimizeResult other = solveFromAllLoops(graph, system, params);
    const int iterations = result.iterations + other.iterations;
    if (agreeingEdges(other) > agreeingEdges(result)) result = std::move(other);
    result.iterations = iterations;
  } else if (!done) {
    BestOfStarts best(graph, params, std::move(result));
    if (!gnc) best.offer(solveFromConsistentLoops(graph, system, params));
    const Fit& fit = best.fit();
    if (fit.rejected_loops > fit.agreeing_loops || fit.scale > kHonestScale)
      best.offer(solveFromAllLoops(graph, system, params));
    result = best.take();
  }
  result.agreeing_edges = agreeingEdges(result);
  return result;
}

}  // namespace hyselam_pose_graph

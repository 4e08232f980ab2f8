#include "gnc.hpp"

#include <algorithm>
#include <functional>

#include "consistent_loops.hpp"
#include "descent.hpp"
#include "robust_weights.hpp"

namespace hyselam_pose_graph {

namespace {

using Poses = Descent::Poses;
using SquaredErrors = std::function<void(const Poses&, std::vector<double>*)>;

constexpr double kMuGrowth = 1.4;  // per round, as in the paper
constexpr int kMaxRounds = 6;
constexpr int kMaxLoopDistance = 10;  // poses between loops that can support each other
/// The stated information is rarely exact. Where consistent loops show that errors are smaller, the
/// inlier threshold shrinks with them, times these margins: small for the loops of the first stage,
/// large for the others, whose errors have long tails. (M3500 and intel end the same from 25
/// to 50.)
constexpr double kFirstMargin = 2.0, kMargin = 25.0;
/// The 99.9 % quantile of chi^2 with one degree of freedom divided by that with three.
constexpr double kRotationShare = 10.828 / 16.266;

/// Weighs loops by their squared errors and solves again, until each weight is 0 or 1.
void anneal(const PoseGraph& graph, double threshold, const SquaredErrors& squared_errors,
            const std::function<void()>& solve, const Poses& poses, std::vector<double>* weights) {
  std::vector<double> squared;
  squared_errors(poses, &squared);
  double largest = 0.0;
  for (std::size_t k = 0; k < squared.size(); ++k)
    if (!isOdometry(graph.edges[k])) largest = std::max(largest, squared[k]);
  double mu = gncFirstMu(largest, threshold);
  if (mu <= 0.0) return;  // no outlier
  for (bool undecided = true; undecided; mu *= kMuGrowth) {
    undecided = mu < 1.0;
    for (std::size_t k = 0; k < squared.size(); ++k) {
      if (isOdometry(graph.edges[k])) continue;
      double& weight = (*weights)[k];
      weight = gncWeight(squared[k], threshold, mu);
      undecided = undecided || (weight > 0.0 && weight < 1.0);
    }
    solve();
    squared_errors(poses, &squared);
  }
}

/// The graph with those of its loops that `keep`; `kept`: which edges these are.
PoseGraph withLoops(const PoseGraph& graph, const std::function<bool(std::size_t)>& keep,
                    std::vector<std::size_t>* kept) {
  PoseGraph part = graph;
  part.edges.clear();
  kept->clear();
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (!isOdometry(graph.edges[k]) && !keep(k)) continue;
    part.edges.push_back(graph.edges[k]);
    kept->push_back(k);
  }
  return part;
}

class GncSolver {
 public:
  GncSolver(const PoseGraph& graph, const PoseSystem& system, const OptimizeParams& params)
      : graph_(graph),
        system_(system),
        params_(params),
        threshold_(params.gnc_inlier_threshold),
        poses_(PoseSystem::system(composedPoses(graph))),
        weights_(graph.edges.size(), 1.0) {}

  OptimizeResult solve() {
    const ConsistentLoops all = findConsistentLoops(graph_, threshold_, kMaxLoopDistance);
    selectFirstLoops(all);
    scaleThreshold(all);
    return solveStages(true);
  }

  OptimizeResult solveFrom(const OptimizeResult& known) {
    scaleThreshold(findConsistentLoops(graph_, threshold_, kMaxLoopDistance));
    poses_ = PoseSystem::system(known.poses);
    for (std::size_t k = 0; k < weights_.size(); ++k)
      weights_[k] = known.weights[k] >= kAgreeingWeight ? 1.0 : 0.0;
    return solveStages(false);
  }

 private:
  /// `first`: there are no poses worth starting from.
  OptimizeResult solveStages(bool first) {
    const std::vector<double> selected = weights_;
    solveStage([&](std::size_t k) { return selected[k] > 0.0; }, first);
    // Rejected loops that fit are taken back, until nothing changes.
    std::vector<double> before;
    for (int round = 0; round < kMaxRounds && weights_ != before; ++round) {
      before = weights_;
      const std::vector<char> fits = fits_;
      solveStage([&](std::size_t k) { return fits[k] != 0; }, false);
    }
    result_.poses = PoseSystem::poses(poses_);
    result_.weights = weights_;
    return std::move(result_);
  }

  /// Sets weights 0 and 1.
  void selectFirstLoops(const ConsistentLoops& all) {
    any_support_ = std::any_of(all.support.begin(), all.support.end(), [](int n) { return n > 0; });
    if (!any_support_) {
      anneal(
          graph_, threshold_ * kRotationShare,
          [&](const Poses& p, std::vector<double>* s) { system_.rotationCosts(p, s); },
          [&] { system_.relaxRotations(weights_, &poses_); }, poses_, &weights_);
      return;
    }
    const ConsistentLoops closest = findConsistentLoops(
        graph_, threshold_ * std::min(1.0, kFirstMargin * all.error_scale), kMaxLoopDistance);
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      weights_[k] = isOdometry(graph_.edges[k]) || closest.support[k] > 0 ? 1.0 : 0.0;
    }
  }
  /// The threshold of the stages after the first selection; without consistent loops as it was.
  void scaleThreshold(const ConsistentLoops& all) {
    threshold_ *= std::min(1.0, kMargin * all.error_scale);
  }

  /// Anneals odometry and the loops that `keep`, then finds the loops that fit the result.
  void solveStage(const std::function<bool(std::size_t)>& keep, bool first) {
    std::vector<std::size_t> kept;
    const PoseGraph part = withLoops(graph_, keep, &kept);
    const PoseSystem part_system(part);
    Descent descent(part_system, params_);
    descent.weights.assign(part.edges.size(), 1.0);
    if (first) any_support_ ? descent.initializeChordal(&poses_) : descent.solvePositions(&poses_);
    anneal(
        part, threshold_,
        [&](const Poses& p, std::vector<double>* s) { part_system.edgeCosts(p, s); },
        [&] {
          first ? static_cast<void>(descent.initializeChordal(&poses_))
                : static_cast<void>(descent.descend(&poses_, 2));
        },
        poses_, &descent.weights);
    result_.converged = descent.descend(&poses_, params_.max_iterations);
    result_.iterations += descent.iterations();
    std::fill(weights_.begin(), weights_.end(), 0.0);
    for (std::size_t k = 0; k < kept.size(); ++k) weights_[kept[k]] = descent.weights[k];
    // A loop with a large error still fits where the covariance of the graph is large.
    fits_.assign(weights_.size(), 0);
    if (!descent.factorAt(poses_)) return;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      fits_[k] = weights_[k] > 0.0 || descent.innovation(system_.edges()[k], poses_) <= threshold_;
    }
  }

  const PoseGraph& graph_;
  const PoseSystem& system_;
  const OptimizeParams& params_;
  double threshold_;
  Poses poses_;
  std::vector<double> weights_;
  std::vector<char> fits_;  ///< edges that may be true, by the last stage
  bool any_support_ = false;
  OptimizeResult result_;
};

}  // namespace

OptimizeResult solveGnc(const PoseGraph& graph, const PoseSystem& system,
                        const OptimizeParams& params) {
  return GncSolver(graph, system, params).solve();
}

OptimizeResult solveGncFrom(const OptimizeResult& known, const PoseGraph& graph,
                            const PoseSystem& system, const OptimizeParams& params) {
  return GncSolver(graph, system, params).solveFrom(known);
}

}  // namespace hyselam_pose_graph

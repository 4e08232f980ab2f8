#include "gnc.hpp"

#include <algorithm>
#include <functional>

#include "descent.hpp"
#include "loop_company.hpp"
#include "robust_weights.hpp"

namespace hyselam_pose_graph {

namespace {

using Poses = Descent::Poses;
using Squares = std::function<void(const Poses&, std::vector<double>*)>;

constexpr double kGrowth = 1.4;  // of mu per round, as its authors have it
constexpr int kRounds = 6;
constexpr int kReach = 10;  // poses between loops that keep each other company
/// Edges are rarely worth just what they say. Where company shows them better, the limit of what
/// may be true is tighter, with this to spare: little for those that decide where all begins, more
/// for the others, whose errors have long tails. (M3500 and intel end the same from 25 to 50.)
constexpr double kSpareFirst = 2.0, kSpare = 25.0;
/// The 99.9 % quantile of chi^2 with one degree of freedom beside that with three.
constexpr double kTurnShare = 10.828 / 16.266;

/// Weighs loops by their squared errors and solves again, until each is in or out.
void anneal(const PoseGraph& graph, double limit, const Squares& squares,
            const std::function<void()>& solve, const Poses& poses, std::vector<double>* weights) {
  std::vector<double> squared;
  squares(poses, &squared);
  double largest = 0.0;
  for (std::size_t k = 0; k < squared.size(); ++k)
    if (!isOdometry(graph.edges[k])) largest = std::max(largest, squared[k]);
  double mu = gncFirstMu(largest, limit);
  if (mu <= 0.0) return;  // nothing contradicts
  for (bool undecided = true; undecided; mu *= kGrowth) {
    undecided = mu < 1.0;
    for (std::size_t k = 0; k < squared.size(); ++k) {
      if (isOdometry(graph.edges[k])) continue;
      double& weight = (*weights)[k];
      weight = gncWeight(squared[k], limit, mu);
      undecided = undecided || (weight > 0.0 && weight < 1.0);
    }
    solve();
    squares(poses, &squared);
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

}  // namespace

OptimizeResult solveGnc(const PoseGraph& graph, const PoseSystem& system,
                        const OptimizeParams& params) {
  OptimizeResult result;
  Poses poses = PoseSystem::system(composedPoses(graph));
  std::vector<double> weights(graph.edges.size(), 1.0);
  double limit = params.gnc_inlier;
  LoopCompany company = findCompany(graph, limit, kReach);
  const bool in_company = std::any_of(company.companions.begin(), company.companions.end(),
                                      [](int n) { return n > 0; });
  if (in_company) {
    const double scale = company.scale;
    company = findCompany(graph, limit * std::min(1.0, kSpareFirst * scale), kReach);
    limit *= std::min(1.0, kSpare * scale);
    for (std::size_t k = 0; k < weights.size(); ++k)
      weights[k] = isOdometry(graph.edges[k]) || company.companions[k] > 0 ? 1.0 : 0.0;
  } else {
    anneal(
        graph, limit * kTurnShare,
        [&](const Poses& p, std::vector<double>* s) { system.turnCosts(p, s); },
        [&] { system.chordalRotations(weights, &poses); }, poses, &weights);
  }

  std::vector<std::size_t> kept;
  std::vector<char> fits;  // edges that may be true, by the last stage
  const auto stage = [&](const std::function<bool(std::size_t)>& keep, bool last) {
    const PoseGraph part = withLoops(graph, keep, &kept);
    const PoseSystem part_system(part);
    Descent descent(part_system, params);
    descent.weights.assign(part.edges.size(), 1.0);
    if (!last) in_company ? descent.relax(&poses) : descent.placeByRotations(&poses);
    anneal(
        part, limit, [&](const Poses& p, std::vector<double>* s) { part_system.edgeCosts(p, s); },
        [&] {
          last ? static_cast<void>(descent.descend(&poses, 2))
               : static_cast<void>(descent.relax(&poses));
        },
        poses, &descent.weights);
    result.converged = descent.descend(&poses, params.max_iterations);
    result.iterations += descent.iterations();
    std::fill(weights.begin(), weights.end(), 0.0);
    for (std::size_t k = 0; k < kept.size(); ++k) weights[kept[k]] = descent.weights[k];
    // What the graph leaves open makes room for loops that look wrong at these poses.
    fits.assign(weights.size(), 0);
    if (!descent.judgeAt(poses)) return;
    for (std::size_t k = 0; k < weights.size(); ++k)
      fits[k] = weights[k] > 0.0 || descent.innovation(system.edges()[k], poses) <= limit;
  };
  const std::vector<double> chosen_first = weights;
  stage([&](std::size_t k) { return chosen_first[k] > 0.0; }, false);
  // Loops come back that may be true after all, until that changes nothing.
  std::vector<double> before;
  for (int round = 0; round < kRounds && weights != before; ++round) {
    before = weights;
    const std::vector<char> chosen = fits;
    stage([&](std::size_t k) { return chosen[k] != 0; }, true);
  }

  result.poses = PoseSystem::poses(poses);
  result.weights = weights;
  return result;
}

}  // namespace hyselam_pose_graph

// The search from the first assignment to the proof: sector by sector of an unknown heading, step
// by step towards worse assignments.
#include <algorithm>
#include <cmath>

#include "angles.hpp"
#include "exact_search.hpp"
#include "local_search.hpp"

namespace hyselam_topo::merging {
namespace {

/// An unknown heading is searched in as many parts of the circle.
constexpr int kSectors = 16;
/// Sectors overlap by this, so that no heading is lost between two of them [rad].
constexpr double kSectorMargin = 1e-9;
/// Of the quick first assignment where the heading is not known or time is short.
constexpr std::size_t kFirstRevisits = 20;
/// Nodes before the search goes about it step by step.
constexpr std::uint64_t kFirstNodes = 40;
/// The first step is to look for assignments that lose less than this; each next one more by a
/// factor.
constexpr double kFirstLoss = 0.02;
constexpr double kLossFactor = 1.15;
constexpr double kLossFactorOfGroup = 1.25;
/// Names times vertices from which a first assignment is improved before, ...
constexpr int kLargeProblem = 1000;
/// ... for this share of the time limit, or of this if that is less [s].
constexpr double kLocalSearchShare = 0.25;
constexpr double kMaxTimeLimit = 4.0;
/// More than any heading [rad].
constexpr double kAnyHeading = 10.0;

}  // namespace

void ExactSearch::listSectors(double first_heading) {
  if (problem_.heading || problem_.sides.empty()) {
    sectors_ = {{{problem_.heading.value_or(0.0), heading_slack_}, -kAnyHeading, kAnyHeading, {}}};
    return;
  }
  const double width = 2.0 * kPi / kSectors;
  const auto edge = [&](int k) { return -kPi + k * width; };
  for (int k = 0; k < kSectors; ++k)
    // Each heading belongs to one sector, the ends of the circle too.
    sectors_.push_back({{edge(k) + 0.5 * width, 0.5 * width + kSectorMargin},
                        k == 0 ? -kAnyHeading : edge(k),
                        k + 1 == kSectors ? kAnyHeading : edge(k + 1),
                        {}});
  const auto distance = [&](const HeadingSector& sector) {
    return std::abs(wrapAngleOnce(sector.heading.value - first_heading));
  };
  std::stable_sort(
      sectors_.begin(), sectors_.end(),
      [&](const HeadingSector& a, const HeadingSector& b) { return distance(a) < distance(b); });
}

bool ExactSearch::searchAllSectors() {
  unexplored_ = std::numeric_limits<double>::infinity();
  for (HeadingSector& sector : sectors_) {
    sector_ = &sector;
    losses_.setHeading(sector.heading);
    if (stopped_)
      noteUnexplored(proven_);
    else
      search(0, proven_);
  }
  return !stopped_;
}

void ExactSearch::searchDeeper(double known_fitness) {
  // All that may lose less than so much, then than more, until the best assignments are among it:
  // so little time is lost on what a bad first assignment would let pass.
  const double known = std::min(1.0, 1.0 - known_fitness);
  for (HeadingSector& sector : sectors_) sector.groups = groups_.find();
  for (double loss = kFirstLoss; !stopped_; loss *= kLossFactor) {
    const bool last = loss >= known;
    const double limit = std::min(loss, known);
    solutions_.restart(1.0 - limit);
    const bool all = searchAllSectors();
    const double found = solutions_.any() ? 1.0 - solutions_.best() : 1.0;
    if (!all) {
      proven_ = std::max(proven_, std::min(unexplored_, limit));
      return;
    }
    proven_ = std::min(limit, found);
    if (last || found <= limit + kEqualFitness) return;
    if (found < 1.0) loss = found / kLossFactor;  // within keep_within of the limit: once more
  }
}

PlaceAssignment ExactSearch::firstAssignment() {
  PlaceAssignment first;
  if (!problem_.heading && !problem_.sides.empty()) {
    first = treeSearch(problem_, params_, kFirstRevisits);
    if (first.found()) solutions_.expect(first.best().fitness);
  }
  return first;
}

void ExactSearch::improveFirst(PlaceAssignment& first) {
  for (const MatchSolution& s : solutions_.kept())
    if (!first.found() || s.fitness > first.best().fitness) first.solutions = {s};
  // In large problems the first assignments are far from good.
  if (!first.found()) first = treeSearch(problem_, params_, 0);
  const bool large = problem_.nameCount() * problem_.vertexCount() > at(kLargeProblem);
  if (first.found() && large)
    first.solutions[0] =
        searchLocally(problem_, params_, terms_, first.best(),
                      kLocalSearchShare * std::min(params_.time_limit, kMaxTimeLimit));
  if (first.found()) solutions_.expect(first.best().fitness);
}

PlaceAssignment ExactSearch::run() {
  PlaceAssignment first = firstAssignment();
  listSectors(first.found() ? first.best().heading : 0.0);
  max_nodes_ = kFirstNodes;
  if (!searchAllSectors()) {
    stopped_ = watch_.seconds() > params_.time_limit;
    max_nodes_ = std::numeric_limits<std::uint64_t>::max();
    improveFirst(first);
    searchDeeper(first.found() ? first.best().fitness : -1.0);
    unexplored_ = proven_;
  }
  if (first.found() && first.best().fitness > solutions_.best() + kEqualFitness) {
    solutions_.restart(first.best().fitness);
    solutions_.offer(first.best());
  }
  PlaceAssignment match = solutions_.finish();
  match.optimal = !stopped_;
  if (stopped_)
    match.gap = std::max(
        0.0, 1.0 - std::min(1.0, unexplored_) - (match.found() ? match.best().fitness : 0.0));
  if (stopped_ && match.found() && match.gap <= kEqualFitness) match.optimal = true;
  match.scale = terms_.scale();
  match.nodes = visited_;
  match.microseconds = watch_.seconds() * 1e6;
  return match;
}

NameGroup::MinLoss ExactSearch::minLoss(std::uint64_t max_nodes, double known) {
  listSectors(0.0);
  NameGroup::MinLoss least;
  least.loss = known;
  max_nodes_ = max_nodes;
  double loss = std::max(kFirstLoss, kLossFactorOfGroup * known);
  while (loss < 1.0) {
    solutions_.restart(1.0 - loss);
    if (!searchAllSectors()) break;
    least.loss = loss;
    loss *= kLossFactorOfGroup;
    if (!solutions_.any()) continue;
    least.loss = std::max(0.0, 1.0 - solutions_.best() - kEqualFitness);
    least.exact = true;
    const Assignment& best = solutions_.kept().front().assignment;
    for (std::size_t v = 0; v < best.size(); ++v)
      if (best[v] >= 0) least.used.insert(v);
    break;
  }
  return least;
}

}  // namespace hyselam_topo::merging

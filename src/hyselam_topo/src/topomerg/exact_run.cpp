// The search from the first answer to the proof: sector by sector of an unknown heading, step by
// step towards worse answers.
#include <algorithm>
#include <cmath>

#include "exact_search.hpp"
#include "improve.hpp"

namespace hyselam_topo {
namespace merging {
namespace {

/// An unknown heading is searched in as many parts of the circle.
constexpr int kSectors = 16;
/// Of the quick first answer where the heading is not known or time is short.
constexpr std::size_t kFirstRevisits = 20;
/// Nodes before the search goes about it step by step.
constexpr std::uint64_t kFirstNodes = 40;
/// The first step is to look for answers that lose less than this; each next one more by a factor.
constexpr double kFirstLoss = 0.02;
constexpr double kDeeper = 1.15;
/// Names times vertices from which a first answer is made better before.
constexpr int kLarge = 1000;
constexpr double kLongest = 4.0;  ///< [s]
constexpr double kAnyHeading = 10.0;

}  // namespace

void ExactSearch::listSectors(double start) {
  if (problem_.heading || problem_.sides.empty()) {
    all_sectors_ = {{{problem_.heading.value_or(0.0), slack_}, -kAnyHeading, kAnyHeading, {}}};
    return;
  }
  const double width = 2.0 * kPi / kSectors;
  const auto edge = [&](int k) { return -kPi + k * width; };
  for (int k = 0; k < kSectors; ++k)
    // Each heading belongs to one sector, the ends of the circle too.
    all_sectors_.push_back({{edge(k) + 0.5 * width, 0.5 * width + 1e-9},
                            k == 0 ? -kAnyHeading : edge(k),
                            k + 1 == kSectors ? kAnyHeading : edge(k + 1),
                            {}});
  std::stable_sort(all_sectors_.begin(), all_sectors_.end(), [&](const Sector& a, const Sector& b) {
    return std::abs(wrapped(a.heading.value - start)) < std::abs(wrapped(b.heading.value - start));
  });
}

bool ExactSearch::searchAll() {
  unexplored_ = std::numeric_limits<double>::infinity();
  for (Sector& sector : all_sectors_) {
    heading_ = sector.heading;
    sector_low_ = sector.low;
    sector_high_ = sector.high;
    groups_ = &sector.groups;
    if (stopped_)
      note(proven_);
    else
      search(0, proven_);
  }
  return !stopped_;
}

void ExactSearch::deepen(double known_fitness) {
  // All that may lose less than so much, then than more, until the best answers are among it: so
  // little time is lost on what a bad first answer would let pass.
  const double known = std::min(1.0, 1.0 - known_fitness);
  for (Sector& sector : all_sectors_) sector.groups = findGroups();
  for (double loss = kFirstLoss; !stopped_; loss *= kDeeper) {
    const bool last = loss >= known;
    const double limit = std::min(loss, known);
    solutions_.restart(1.0 - limit);
    const bool all = searchAll();
    const double found = solutions_.any() ? 1.0 - solutions_.best() : 1.0;
    if (!all) {
      proven_ = std::max(proven_, std::min(unexplored_, limit));
      return;
    }
    proven_ = std::min(limit, found);
    if (last || found <= limit + kEqualFitness) return;
    if (found < 1.0) loss = found / kDeeper;  // within keep_within of the limit: once more
  }
}

Match ExactSearch::run() {
  Match first;
  if (!problem_.heading && !problem_.sides.empty()) {
    first = treeSearch(problem_, params_, kFirstRevisits);
    if (first.found()) solutions_.expect(first.best().fitness);
  }
  listSectors(first.found() ? first.best().heading : 0.0);
  max_nodes_ = kFirstNodes;
  if (!searchAll()) {
    stopped_ = watch_.seconds() > params_.time_limit;
    max_nodes_ = std::numeric_limits<std::uint64_t>::max();
    for (const MatchSolution& s : solutions_.kept())
      if (!first.found() || s.fitness > first.best().fitness) first.solutions = {s};
    // In large problems the first answers are far from good.
    if (!first.found()) first = treeSearch(problem_, params_, 0);
    if (first.found() && n_ * m_ > kLarge)
      first.solutions[0] = improved(problem_, params_, terms_, first.best(),
                                    0.25 * std::min(params_.time_limit, kLongest));
    if (first.found()) solutions_.expect(first.best().fitness);
    const double known = first.found() ? first.best().fitness : -1.0;
    deepen(known);
    unexplored_ = proven_;
  }
  if (first.found() && first.best().fitness > solutions_.best() + kEqualFitness) {
    solutions_.restart(first.best().fitness);
    solutions_.offer(first.best());
  }
  Match match = solutions_.finish();
  match.optimal = !stopped_;
  if (stopped_)
    match.gap = std::max(
        0.0, 1.0 - std::min(1.0, unexplored_) - (match.found() ? match.best().fitness : 0.0));
  if (stopped_ && match.found() && match.gap <= kEqualFitness) match.optimal = true;
  match.nodes = visited_;
  match.microseconds = watch_.seconds() * 1e6;
  return match;
}

}  // namespace merging

Match solveExact(const MatchProblem& problem, const MatchParams& params) {
  checkMatchParams(params);
  const merging::Terms terms(problem, params.fitness);
  return merging::ExactSearch(problem, params, terms).run();
}

}  // namespace hyselam_topo

// The assignments that are worth keeping, the best first.
#pragma once

#include <time.h>

#include <algorithm>
#include <vector>

#include "fitness_terms.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo::merging {

/// Processor time of the thread: a busy machine cuts no search shorter than an idle one does, so
/// that the same talk ends with the same names on both.
class Stopwatch {
 public:
  double seconds() const { return now() - start_; }

 private:
  static double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double start_ = now();
};

/// Fewer places first, then in the order of the assignments.
bool preferred(const MatchSolution& a, const MatchSolution& b);

class Solutions {
 public:
  explicit Solutions(const SolverParams& params) : params_(params) {}

  bool any() const { return !kept_.empty(); }
  double best() const { return best_; }
  /// An assignment that is worse than this is of no use.
  double needed() const { return floor_ - params_.keep_within - kEqualFitness; }
  /// An assignment of this fitness is known to exist, and will be offered if nothing better comes.
  void expect(double fitness) { floor_ = std::max(floor_, fitness); }
  /// No further assignment is needed that is only as good as the best and names as many places.
  bool full() const { return full_; }
  std::size_t fewest() const { return fewest_; }
  const std::vector<MatchSolution>& kept() const { return kept_; }

  /// Takes an assignment if it is good enough; each assignment may come once only.
  void offer(MatchSolution solution);
  /// Forgets all assignments; those that come must be about as good as `fitness`.
  void restart(double fitness);
  /// What is left, in order.
  PlaceAssignment finish();

 private:
  void trim();

  const SolverParams params_;
  std::vector<MatchSolution> kept_;
  double best_ = -1.0;
  double floor_ = -1.0;  ///< >= best_
  std::size_t fewest_ = 0;
  bool full_ = false;
  bool more_ = false;
};

}  // namespace hyselam_topo::merging

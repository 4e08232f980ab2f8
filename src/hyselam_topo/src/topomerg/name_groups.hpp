// Names that belong together, each group a problem of its own: what it loses at least.
#pragma once

#include <vector>

#include "name_tables.hpp"
#include "search_state.hpp"
#include "solutions.hpp"

namespace hyselam_topo::merging {

/// A name that several others are connected to, and those of them that are not such a name
/// themselves.
struct NameGroup {
  int hub = 0;
  std::vector<int> names;  ///< with the hub
  /// Lost among them in any assignment, if those of the hub vertices are taken by others.
  struct MinLoss {
    PlaceSet taken;
    double loss = 0.0;
    bool exact = false;  ///< an assignment that loses so little ...
    PlaceSet used;       ///< ... is made of these
  };
  std::vector<MinLoss> known;
};

class NameGroups {
 public:
  /// All must outlive this. `watch`: since when params.time_limit counts.
  NameGroups(const MatchProblem& problem, const SolverParams& params, const FitnessTerms& terms,
             const NameTables& tables, const Stopwatch& watch)
      : problem_(problem), params_(params), terms_(terms), tables_(tables), watch_(watch) {}

  std::vector<NameGroup> find() const;
  /// What the names of the group lose at least, if these vertices are taken by others.
  double minLoss(NameGroup& group, const PlaceSet& taken, Heading heading) const;

 private:
  const MatchProblem& problem_;
  const SolverParams& params_;
  const FitnessTerms& terms_;
  const NameTables& tables_;
  const Stopwatch& watch_;
};

}  // namespace hyselam_topo::merging

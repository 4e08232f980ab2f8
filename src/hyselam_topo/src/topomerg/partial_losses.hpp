// What a name loses, given the names that have got their vertices: with certain vertices, with
// none, with a partial set at least, and with any set of a large piece at least.
#pragma once

#include "name_tables.hpp"
#include "partial_set.hpp"
#include "search_node.hpp"
#include "search_state.hpp"

namespace hyselam_topo::merging {

class PartialLosses {
 public:
  /// All must outlive this.
  PartialLosses(const MatchProblem& problem, const FitnessTerms& terms, const NameTables& tables,
                const SearchState& state)
      : problem_(problem), terms_(terms), tables_(tables), state_(state) {}

  void setHeading(Heading heading) { heading_ = heading; }
  const Heading& heading() const { return heading_; }

  double exactLoss(int name, const VertexSet& vertices) const;
  /// Of a name that stays without vertices. `partial` (a name that is being given vertices) may be
  /// null, here and below.
  double emptyLoss(int name, const PartialSet* partial) const;
  double looseLoss(int name, const LooseAnchor& loose, const PartialSet* partial) const;
  /// At least, of the name of a partial set.
  double partialLoss(const PartialSet& partial) const;
  PartialSetView viewOf(const VertexSet& vertices, const PartialSet& partial) const;
  /// Whether all names of a clause but `name` have got their vertices.
  bool isKnown(const FitnessTerms::Clause& clause, int name) const;

 private:
  double relationsLoss(int name, const VertexSet& vertices) const;
  bool mayShareWall(const PlaceSet& a, const PlaceSet& b) const;
  // Parts of partialLoss(); the second goes on adding to `loss`.
  double partialAreaLoss(const PartialSet& partial) const;
  double addPartialEdges(double loss, const PartialSet& partial) const;
  double partialSideLoss(const MatchProblem::DescribedSide& side, const PartialSet& partial,
                         int other) const;

  const MatchProblem& problem_;
  const FitnessTerms& terms_;
  const NameTables& tables_;
  const SearchState& state_;
  Heading heading_;
};

}  // namespace hyselam_topo::merging

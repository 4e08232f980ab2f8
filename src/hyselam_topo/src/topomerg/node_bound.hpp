// What an assignment loses at least, given the names that have got their vertices. Each other name
// needs a vertex of its own, the largest of its set, or goes without: the cheapest such choice for
// all of them together is an assignment problem. A name's cost for a vertex is the least of what
// any set with that largest vertex would lose: listed set by set where the free vertices fall apart
// into small pieces, estimated where they do not.
#pragma once

#include <vector>

#include "name_groups.hpp"
#include "partial_losses.hpp"
#include "set_table.hpp"

namespace hyselam_topo::merging {

class NodeBound {
 public:
  /// All must outlive this.
  NodeBound(const MatchProblem& problem, const FitnessTerms& terms, const NameTables& tables,
            const SetTable& sets, const SearchState& state, const PartialLosses& losses,
            const NameGroups& groups);

  /// Fills the node and returns its bound, at least node.base; ends early once that exceeds
  /// `max_loss`. `partial`, the name that is being given vertices, may be null. Groups of which no
  /// name has vertices yet count as a whole.
  double compute(SearchNode& node, const PartialSet* partial, std::vector<NameGroup>& groups,
                 double max_loss);

 private:
  /// What several names lose that belong to groups without any vertices yet.
  struct Untouched {
    double loss = 0.0;
    std::size_t names = 0;
  };
  /// Least loss of a name whose edges to names without vertices yet cannot be met, ...
  struct Isolated {
    double missing = 0.0;  ///< ... because its set has no available neighbors, nor walls,
    double wall = 0.0;     ///< or no neighbors, but walls that it shares,
    double absent = 0.0;   ///< or because it stays without a set
  };
  enum Surroundings : char { kFreeNeighbors, kFreeAcrossWalls, kNothingFree };

  bool isUntouched(const NameGroup& group, const PartialSet* partial) const;
  Untouched boundUntouchedGroups(const PartialSet* partial, std::vector<NameGroup>& groups);
  void listRows(SearchNode& node, int near) const;
  void prepareSets(const SearchNode& node);
  void viewPartial(const SearchNode& node, const PartialSet& partial);
  void viewLast(const SearchNode& node, int last);
  /// Costs of the row's name with each set and vertex; what it adds to the bound.
  double fillRow(SearchNode& node, std::size_t row, const PartialSet* partial, int last);
  Isolated isolatedLoss(const SearchNode& node, int name) const;
  /// What a name loses with each set because of the name closed last, on top of `before`.
  void addLast(const SearchNode& node, int name, int last, const double* before, double* now);
  /// `before` + `edge` + what side `number` loses, added in an order of its own for each rule.
  double addLastSide(double before, double edge, int number, int name, int last, std::size_t s,
                     int set);
  void addLastClauses(const SearchNode& node, int name, int last, double* now) const;
  /// Adds the same because of a partial set.
  void addPartial(int name, const PartialSet& partial, double* cost);
  double partialEdgeLoss(int name, std::size_t set, const PartialSet& partial);
  /// What a set of the node loses of a side through its doors: the same for all names that were
  /// described on the same side, so it is computed once.
  template <typename Compute>
  double cachedDoorLoss(int side, bool from_set, std::size_t set, Compute&& compute) {
    const std::size_t row = 2 * at(tables_.directionOf(side)) + (from_set ? 1 : 0);
    double& loss = door_losses_[row * set_count_ + set];
    if (loss < 0.0) loss = compute();
    return loss;
  }

  const MatchProblem& problem_;
  const FitnessTerms& terms_;
  const NameTables& tables_;
  const SetTable& sets_;
  const SearchState& state_;
  const PartialLosses& losses_;
  const NameGroups& groups_;

  /// Names x listed sets, for each number of closed names: what the name would lose with that set,
  /// alone and with them.
  std::vector<std::vector<double>> losses_at_level_;

  // Of the node whose bound is computed:
  std::vector<char> is_untouched_;  ///< of each name: of an untouched group
  // Of each of its sets:
  std::size_t set_count_ = 0;
  std::vector<Contact> contacts_;  ///< with the name closed last
  std::vector<double> bearings_;   ///< from the set to that name
  std::vector<PartialSetView> views_;
  std::vector<double> touch_costs_;  ///< of a name that is not described as connected to `partial`
  std::vector<int> columns_;         ///< of the table
  std::vector<Surroundings> surroundings_;
  /// (2 x directions) x sets, see cachedDoorLoss(); -1: not yet.
  std::vector<double> door_losses_;
};

}  // namespace hyselam_topo::merging

// Branch and bound over the names: one name after the other gets its final vertices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "name_groups.hpp"
#include "node_bound.hpp"
#include "partial_losses.hpp"
#include "search_state.hpp"
#include "set_table.hpp"
#include "solutions.hpp"

namespace hyselam_topo::merging {

/// A part of the circle in which an unknown heading is searched.
struct HeadingSector {
  Heading heading;
  // Assignments whose best heading is not within low .. high are left to other sectors.
  double low = 0.0;
  double high = 0.0;
  std::vector<NameGroup> groups;
};

class ExactSearch {
 public:
  /// All must outlive this.
  ExactSearch(const MatchProblem& problem, const SolverParams& params, const FitnessTerms& terms);

  /// A known heading is known up to this only [rad].
  void setHeadingSlack(double slack) { heading_slack_ = slack; }
  PlaceAssignment run();
  /// What any assignment loses, as far as so many nodes can tell; at least `known`.
  NameGroup::MinLoss minLoss(std::uint64_t max_nodes, double known);

 private:
  /// What a name may take.
  struct Choice {
    double bound = 0.0;
    int set = -1;   ///< in the node's list, or
    int seed = -1;  ///< the anchor of sets that are not listed; both -1: no vertices
  };

  // The search from the first assignment to the proof (exact_search_run.cpp).
  PlaceAssignment firstAssignment();
  void improveFirst(PlaceAssignment& first);
  /// With limits on the loss that grow step by step.
  void searchDeeper(double known_fitness);
  bool searchAllSectors();
  void listSectors(double first_heading);

  // Nodes. `known`: no assignment from here loses less.
  void search(std::size_t depth, double known);
  void branch(SearchNode& here, int name, std::size_t depth);
  void startFrom(int name, const VertexSet& has, const PlaceSet& open, std::size_t depth,
                 double known);
  void grow(const PartialSet& partial, std::size_t depth, double known);
  void boundPartial(PartialSet& partial) const;
  void close(int name, const VertexSet& vertices, std::size_t depth, double known);
  void closeLast(int name, std::size_t depth, double known);
  void leaf();

  SearchNode& node(std::size_t depth);
  double bound(SearchNode& node, const PartialSet* partial);
  bool canPrune(double bound, std::size_t min_named_vertices) const;
  /// What is left to lose in the table of the node.
  double room(const SearchNode& node) const { return 1.0 - solutions_.needed() - node.table_bound; }
  std::size_t minNamedVertices(const SearchNode& node) const;
  int nextName(const SearchNode& node) const;
  int nextConfirmedName() const;
  int nextHub(const SearchNode& node) const;
  int nameOfFewestChoices(const SearchNode& node) const;
  std::vector<Choice> choicesOf(const SearchNode& node, int name) const;
  bool stopped();
  void noteUnexplored(double bound) { unexplored_ = std::min(unexplored_, bound); }

  const MatchProblem& problem_;
  const SolverParams& params_;
  const FitnessTerms& terms_;
  const NameTables tables_;
  SearchState state_;
  const SetTable sets_;
  PartialLosses losses_;
  const Stopwatch watch_;
  const NameGroups groups_;
  NodeBound bound_;

  double heading_slack_ = 0.0;
  std::vector<HeadingSector> sectors_;
  HeadingSector* sector_ = nullptr;  ///< that is searched

  std::deque<SearchNode> nodes_;  ///< by depth
  Solutions solutions_;
  std::uint64_t max_nodes_ = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t visited_ = 0;
  bool stopped_ = false;
  double proven_ = 0.0;  ///< no assignment loses less
  double unexplored_ = std::numeric_limits<double>::infinity();
};

}  // namespace hyselam_topo::merging

// Branch and bound over the names: one name after the other gets its final vertices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "assignment_bound.hpp"
#include "merge_terms.hpp"
#include "solutions.hpp"

namespace hyselam_topo::merging {

/// A set of free vertices that a name may take as a whole.
struct CandidateSet {
  Vertices vertices;
  int anchor = 0;       ///< its largest vertex
  int touch_begin = 0;  ///< of the names that have got theirs and touch it
  int touch_end = 0;
  bool touches_grown = false;  ///< the vertices of the name that is being built
  bool may_touch_grown = false;
};

struct Touch {
  int name = 0;
  double bearing = 0.0;  ///< from the set to the name
};

/// The vertices of the name that is being built: those it has, and those that it may get.
struct Growth {
  int name = -1;
  Vertices has;
  PlaceSet open;
  // Where its centre may come to lie: in this circle.
  double x = 0.0, y = 0.0, radius = 0.0;
};

/// What is known at one node of the search.
struct Node {
  struct Piece {
    PlaceSet vertices;
    double area = 0.0;
  };
  double base = 0.0;   ///< lost among the names that have got their vertices
  double bound = 0.0;  ///< lost at least by any answer from here
  std::vector<CandidateSet> sets;
  std::vector<Touch> touches;
  std::vector<int> rows;       ///< names of the rows of the table
  std::vector<int> row_of;     ///< of each name, -1: none
  std::vector<int> column_of;  ///< of each vertex, -1: none
  std::vector<double> cost;    ///< rows x sets
  std::vector<Piece> pieces;   ///< of the free map that are too large to list their sets
  std::vector<char> loose;     ///< of each vertex: not all of its sets are listed
  AssignmentBound table;       ///< rows x vertices
  double assigned = 0.0;       ///< the table's least sum
};

class ExactSearch {
 public:
  ExactSearch(const MatchProblem& problem, const MatchParams& params);
  Match run();

 private:
  struct Choice {
    double bound = 0.0;
    int set = -1;   ///< in the node's list, or
    int seed = -1;  ///< the largest vertex of sets that are not listed; both -1: no vertices
  };

  void runSector();
  void search(std::size_t depth, double known);
  void branch(Node* here, int name, std::size_t depth);
  void startFrom(int name, const Vertices& has, PlaceSet open, std::size_t depth, double known);
  void grow(const Growth& growth, std::size_t depth, double known);
  void close(int name, const Vertices& vertices, std::size_t depth, double known);
  void closeLast(int name, std::size_t depth, double known);
  void leaf();

  /// Fills the node and returns its bound; at least `base`. `growth` may be null.
  double bound(Node* node, const Growth* growth);
  void listSets(Node* node, const PlaceSet& available, const Growth* growth);
  void addSet(Node* node, const Vertices& vertices, const Growth* growth);
  double grownLoss(const Growth& growth) const;
  double candidateLoss(const Node& node, int name, const CandidateSet& set,
                       const Growth* growth) const;
  double emptyLoss(int name, const Growth* growth) const;
  double looseLoss(int name, int vertex, const PlaceSet& component, double component_area,
                   const Growth* growth) const;
  void locate(Growth* growth) const;
  void keepReachable(Growth* growth) const;
  double exactLoss(int name, const Vertices& vertices) const;
  double relationsLoss(int name, const Vertices& vertices) const;
  void note(double bound) { unexplored_ = std::min(unexplored_, bound); }
  int nextName(const Node& node) const;
  std::vector<Choice> choicesOf(const Node& node, int name) const;
  std::size_t taken(const Node& node) const;
  bool hopeless(double bound, std::size_t at_least) const;
  bool stopped();
  Node& node(std::size_t depth);

  const MatchProblem& problem_;
  const MatchParams& params_;
  const Terms terms_;
  const int n_;
  const int m_;
  std::vector<int> size_rank_;  ///< of each vertex, 0 is the largest
  std::vector<char> has_fixed_;
  PlaceSet fixed_;
  Heading heading_;
  double sector_low_ = 0.0;  ///< answers whose best heading lies elsewhere are left to others
  double sector_high_ = 0.0;
  bool sectors_ = false;

  std::vector<Vertices> closed_;
  std::vector<char> is_closed_;
  std::vector<int> closed_list_;
  std::vector<int> owner_;        ///< of each vertex, -1: free
  std::vector<int> told_closed_;  ///< of each name: told to be joined to as many closed ones
  PlaceSet free_;
  std::size_t taken_ = 0;
  double base_ = 0.0;

  std::deque<Node> nodes_;
  Solutions solutions_;
  Stopwatch watch_;
  std::uint64_t visited_ = 0;
  bool stopped_ = false;
  double unexplored_ = std::numeric_limits<double>::infinity();
};

}  // namespace hyselam_topo::merging

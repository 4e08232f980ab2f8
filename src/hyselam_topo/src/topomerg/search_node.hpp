// What is known at one node of the exact search.
#pragma once

#include <vector>

#include "fitness_terms.hpp"
#include "hyselam_common/assignment.hpp"

namespace hyselam_topo::merging {

constexpr double kNever = hyselam::Assignment::kNotAllowed;  ///< loss of what is not allowed

/// A set of vertices that a name may take as a whole.
struct CandidateSet {
  VertexSet vertices;
  int anchor = 0;  ///< its first vertex by rank
};

/// A vertex with too many sets to list them.
struct LooseAnchor {
  int anchor = 0;
  PlaceSet piece;      ///< that its sets are made of
  PlaceSet neighbors;  ///< of its vertices, also those that are ranked above the anchor
  double area = 0.0;   ///< of the piece [m^2]
};

struct SearchNode {
  double base = 0.0;                ///< lost among the names that have got their vertices
  double bound = 0.0;               ///< lost at least by any assignment from here
  double table_bound = 0.0;         ///< the same by the assignment table; at most `bound`
  PlaceSet available;               ///< to names that have none and are not confirmed
  std::vector<int> alive;           ///< always-listed sets of available vertices
  std::vector<CandidateSet> extra;  ///< sets that are listed here only
  std::vector<LooseAnchor> loose;
  std::vector<int> rows;       ///< names of the rows of the table
  std::vector<int> row_of;     ///< of each name, -1: none
  std::vector<int> column_of;  ///< of each vertex, -1: none
  std::vector<double> cost;    ///< rows x (alive, then extra)
  hyselam::Assignment table;   ///< rows x available vertices

  std::size_t setCount() const { return alive.size() + extra.size(); }
};

}  // namespace hyselam_topo::merging

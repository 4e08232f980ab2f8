// Where the Cholesky factor of a sparse symmetric matrix of blocks has entries: worked out once per
// graph, used by every factorisation of whatever blocks.
#pragma once

#include <utility>
#include <vector>

namespace hyselam_pose_graph {

/// The pattern of L with P A P^T = L L^T, ordered by approximate minimum degree (AMD of
/// SuiteSparse).
struct CholeskyPattern {
  int size = 0;               ///< rows of blocks
  std::vector<int> position;  ///< of each variable in the order of elimination
  /// Column c of L has its entries at column_begin[c] .. column_begin[c + 1] - 1, by ascending row,
  /// the diagonal first.
  std::vector<int> column_begin;
  std::vector<int> row;
  /// Row r of L left of the diagonal: entries row_begin[r] .. row_begin[r + 1] - 1 of row_entry and
  /// row_column, by ascending column: where they stand in `row`, and their columns.
  std::vector<int> row_begin, row_entry, row_column;

  int entries() const { return static_cast<int>(row.size()); }
  int diagonal(int variable) const {
    return column_begin[static_cast<std::size_t>(position[static_cast<std::size_t>(variable)])];
  }

  /// Where the block of two different variables stands that are coupled in A.
  struct Slot {
    int entry;
    bool transposed;  ///< the entry holds A(b, a), not A(a, b)
  };
  Slot slot(int a, int b) const;
  /// Whether L has room for a block of two different variables.
  bool holds(int a, int b) const;
};

/// `couplings`: pairs of different variables with a block in A, each at least once.
/// @throws std::invalid_argument for variables out of range.
CholeskyPattern analysePattern(int variables, const std::vector<std::pair<int, int>>& couplings);

}  // namespace hyselam_pose_graph

// Symbolic Cholesky factorization of a sparse symmetric block matrix: where the factor has blocks.
// Computed once per graph and used by every numeric factorization (block_cholesky.hpp).
#pragma once

#include <utility>
#include <vector>

namespace hyselam_pose_graph {

/// The pattern of L with P A P^T = L L^T, in an order of little fill (elimination_order.hpp).
struct CholeskyPattern {
  int size = 0;               ///< rows of blocks
  std::vector<int> position;  ///< of each variable in the elimination order
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

  /// The entry of L that holds the block of two different variables coupled in A.
  struct Slot {
    int entry;
    bool transposed;  ///< the entry holds A(b, a), not A(a, b)
  };
  Slot slot(int a, int b) const;
  /// Whether L has an entry for two different variables.
  bool holds(int a, int b) const;
};

/// `couplings`: pairs of different variables with a block in A, each at least once.
/// @throws hyselam::InputError for variables out of range.
CholeskyPattern analyzePattern(int variables, const std::vector<std::pair<int, int>>& couplings);

}  // namespace hyselam_pose_graph

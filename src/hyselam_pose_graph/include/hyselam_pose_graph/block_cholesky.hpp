// Cholesky factorization of sparse symmetric (Hermitian) matrices of small dense blocks,
// left-looking by block columns.
//
// Most of the time of a pose graph goes into products of 3x3 blocks; a scalar sparse library
// follows an index for each of their entries. Measured against CHOLMOD in `bench/run pose_graph`;
// equal to it by test_block_cholesky.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "hyselam_pose_graph/cholesky_pattern.hpp"

namespace hyselam_pose_graph {

/// `Block` gives the dense operations:
///   using Vector                                 what a block is multiplied with
///   static Block zero();
///   void subtractProduct(const Block& a, const Block& b)   *this -= a b^H
///   bool factor()                                *this = L of *this = L L^H; false if not positive
///   void solveRight(const Block& l)              *this = *this l^-H
///   void solveLower(Vector& v), solveUpper(Vector& v)      v = l^-1 v, v = l^-H v
///   void subtractTimes(const Vector& x, Vector& y)         y -= *this x
///   void subtractAdjointTimes(const Vector& x, Vector& y)  y -= *this^H x
template <class Block>
class BlockCholesky {
 public:
  using Vector = typename Block::Vector;

  explicit BlockCholesky(const CholeskyPattern& pattern)
      : pattern_(&pattern),
        values_(static_cast<std::size_t>(pattern.entries())),
        place_(static_cast<std::size_t>(pattern.size)) {}

  /// The matrix to be factorised: only entries of `pattern`, the lower triangle in its order.
  void setZero() { std::fill(values_.begin(), values_.end(), Block::zero()); }
  Block& entry(int i) { return values_[static_cast<std::size_t>(i)]; }
  const Block& entry(int i) const { return values_[static_cast<std::size_t>(i)]; }

  /// Replaces the matrix by its factor. False if it is not positive definite; the entries are
  /// undefined then.
  bool factor() {
    const CholeskyPattern& p = *pattern_;
    Block* const l = values_.data();
    int* const place = place_.data();
    const int* const row = p.row.data();
    for (int c = 0; c < p.size; ++c) {
      const int begin = p.column_begin[static_cast<std::size_t>(c)];
      const int end = p.column_begin[static_cast<std::size_t>(c) + 1];
      for (int q = begin; q < end; ++q) place[row[q]] = q;
      const int row_end = p.row_begin[static_cast<std::size_t>(c) + 1];
      for (int k = p.row_begin[static_cast<std::size_t>(c)]; k < row_end; ++k) {
        const int first = p.row_entry[static_cast<std::size_t>(k)];
        const int column = p.row_column[static_cast<std::size_t>(k)];
        const int last = p.column_begin[static_cast<std::size_t>(column) + 1];
        const Block factor = l[first];
        for (int q = first; q < last; ++q) l[place[row[q]]].subtractProduct(l[q], factor);
      }
      if (!l[begin].factor()) return false;
      const Block diagonal = l[begin];
      for (int q = begin + 1; q < end; ++q) l[q].solveRight(diagonal);
    }
    return true;
  }

  /// Solves A x = b, b in the order of the variables; replaces b by x.
  void solve(std::vector<Vector>* b) const {
    const CholeskyPattern& p = *pattern_;
    std::vector<Vector> x(b->size());
    for (std::size_t i = 0; i < b->size(); ++i)
      x[static_cast<std::size_t>(p.position[i])] = (*b)[i];
    for (int c = 0; c < p.size; ++c) {
      const int begin = p.column_begin[static_cast<std::size_t>(c)];
      const int end = p.column_begin[static_cast<std::size_t>(c) + 1];
      Vector& at = x[static_cast<std::size_t>(c)];
      entry(begin).solveLower(at);
      for (int q = begin + 1; q < end; ++q)
        entry(q).subtractTimes(at, x[static_cast<std::size_t>(p.row[static_cast<std::size_t>(q)])]);
    }
    for (int c = p.size; c-- > 0;) {
      const int begin = p.column_begin[static_cast<std::size_t>(c)];
      const int end = p.column_begin[static_cast<std::size_t>(c) + 1];
      Vector& at = x[static_cast<std::size_t>(c)];
      for (int q = begin + 1; q < end; ++q)
        entry(q).subtractAdjointTimes(
            x[static_cast<std::size_t>(p.row[static_cast<std::size_t>(q)])], at);
      entry(begin).solveUpper(at);
    }
    for (std::size_t i = 0; i < b->size(); ++i)
      (*b)[i] = x[static_cast<std::size_t>(p.position[i])];
  }

  /// The nonzero rows of x = L^-1 b when b is zero except for one variable: those on the path to
  /// the root of the elimination tree. Calls `visit(const Vector&)` for each in this order.
  template <class Visit>
  void solveLowerFrom(int variable, const Vector& b, const Visit& visit) const {
    const CholeskyPattern& p = *pattern_;
    std::map<int, Vector> x;  // few of many columns
    x[p.position[static_cast<std::size_t>(variable)]] = b;
    while (!x.empty()) {
      const int c = x.begin()->first;
      Vector at = x.begin()->second;
      x.erase(x.begin());
      const int begin = p.column_begin[static_cast<std::size_t>(c)];
      const int end = p.column_begin[static_cast<std::size_t>(c) + 1];
      entry(begin).solveLower(at);
      visit(at);
      for (int q = begin + 1; q < end; ++q)
        entry(q).subtractTimes(at, x[p.row[static_cast<std::size_t>(q)]]);
    }
  }

 private:
  const CholeskyPattern* pattern_;
  std::vector<Block> values_;
  std::vector<int> place_;  ///< entry of each row in the current column
};

}  // namespace hyselam_pose_graph

// Disjoint sets of the numbers 0 .. size - 1 (union-find with path halving).
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace hyselam {

/// The representative of a set is its smallest member, whatever the order of unite(): results that
/// depend on it are reproducible.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size = 0) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::size_t size() const { return parent_.size(); }
  /// Adds a set of one member and returns it.
  int add() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  /// The smallest member of the set of `i`.
  int find(int i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  bool connected(int a, int b) { return find(a) == find(b); }
  /// Joins the sets of two members; false if they were one already.
  bool unite(int a, int b) {
    a = find(a);
    b = find(b);
    parent(std::max(a, b)) = std::min(a, b);
    return a != b;
  }

 private:
  int& parent(int i) { return parent_[static_cast<std::size_t>(i)]; }

  std::vector<int> parent_;
};

}  // namespace hyselam

#include "hyselam_pose_graph/cholesky_pattern.hpp"

#include <algorithm>

#include "elimination_order.hpp"

namespace hyselam_pose_graph {

CholeskyPattern::Slot CholeskyPattern::slot(int a, int b) const {
  const int pa = position[static_cast<std::size_t>(a)], pb = position[static_cast<std::size_t>(b)];
  const int column = std::min(pa, pb), wanted = std::max(pa, pb);
  const auto first = row.begin() + column_begin[static_cast<std::size_t>(column)];
  const auto last = row.begin() + column_begin[static_cast<std::size_t>(column) + 1];
  const auto it = std::lower_bound(first, last, wanted);
  // The entry's row is the later one in the order of elimination.
  return {static_cast<int>(it - row.begin()), pa < pb};
}

bool CholeskyPattern::holds(int a, int b) const {
  const int pa = position[static_cast<std::size_t>(a)], pb = position[static_cast<std::size_t>(b)];
  const int column = std::min(pa, pb), wanted = std::max(pa, pb);
  return std::binary_search(row.begin() + column_begin[static_cast<std::size_t>(column)],
                            row.begin() + column_begin[static_cast<std::size_t>(column) + 1],
                            wanted);
}

namespace {

/// The elimination tree and the rows of L (Liu): row r of L has an entry in each column that the
/// tree reaches from the neighbors of r that precede it.
class EliminationTree {
 public:
  EliminationTree(const Adjacency& adjacency, const std::vector<int>& order,
                  const std::vector<int>& position)
      : adjacency_(adjacency),
        order_(order),
        position_(position),
        ancestor_(order.size(), -1),
        parent_(ancestor_),
        mark_(ancestor_) {}

  /// Adds row r, which must come after all rows before it.
  void add(int r) {
    eachNeighbor(r, [&](int c) {
      while (c < r && c >= 0) {  // up to the root, with the path shortened to r
        int& ancestor = ancestor_[static_cast<std::size_t>(c)];
        const int next = ancestor;
        ancestor = r;
        if (next < 0) parent_[static_cast<std::size_t>(c)] = r;
        c = next;
      }
    });
  }
  /// Calls `visit(column)` for each column left of the diagonal in which row r of L has an entry.
  template <typename Visit>
  void eachColumn(int r, const Visit& visit) {
    mark_[static_cast<std::size_t>(r)] = r;
    eachNeighbor(r, [&](int c) {
      if (c > r) return;
      for (; mark_[static_cast<std::size_t>(c)] != r; c = parent_[static_cast<std::size_t>(c)]) {
        mark_[static_cast<std::size_t>(c)] = r;
        visit(c);
      }
    });
  }

 private:
  template <typename Visit>
  void eachNeighbor(int r, const Visit& visit) const {
    const auto v = static_cast<std::size_t>(order_[static_cast<std::size_t>(r)]);
    for (int q = adjacency_.begin[v]; q < adjacency_.begin[v + 1]; ++q) {
      const int neighbor = adjacency_.neighbor[static_cast<std::size_t>(q)];
      visit(position_[static_cast<std::size_t>(neighbor)]);
    }
  }

  const Adjacency& adjacency_;
  const std::vector<int>&order_, &position_;
  std::vector<int> ancestor_, parent_, mark_;
};

/// Fills column_begin, row, row_entry and row_column. Row r of L has entries in the columns
/// row_column[row_begin[r]] .. row_column[row_begin[r + 1] - 1], in any order.
void fillEntries(const std::vector<int>& column_sizes, CholeskyPattern* p) {
  const auto n = static_cast<std::size_t>(p->size);
  p->column_begin.assign(n + 1, 0);
  for (std::size_t c = 0; c < n; ++c) {
    p->column_begin[c + 1] = p->column_begin[c] + column_sizes[c];
  }
  p->row.resize(static_cast<std::size_t>(p->column_begin[n]));
  std::vector<int> next(p->column_begin.begin(), p->column_begin.end() - 1);
  for (std::size_t r = 0; r < n; ++r) {
    const auto add = [&](std::size_t column) {
      p->row[static_cast<std::size_t>(next[column]++)] = static_cast<int>(r);
    };
    add(r);
    for (int k = p->row_begin[r]; k < p->row_begin[r + 1]; ++k)
      add(static_cast<std::size_t>(p->row_column[static_cast<std::size_t>(k)]));
  }
  // Column by column, each row gets its entries by ascending column.
  p->row_entry.resize(p->row_column.size());
  next.assign(p->row_begin.begin(), p->row_begin.end() - 1);
  for (std::size_t c = 0; c < n; ++c)
    for (int q = p->column_begin[c] + 1; q < p->column_begin[c + 1]; ++q) {
      const auto r = static_cast<std::size_t>(p->row[static_cast<std::size_t>(q)]);
      const auto at = static_cast<std::size_t>(next[r]++);
      p->row_entry[at] = q;
      p->row_column[at] = static_cast<int>(c);
    }
}

}  // namespace

CholeskyPattern analyzePattern(int variables, const std::vector<std::pair<int, int>>& couplings) {
  const auto n = static_cast<std::size_t>(variables);
  const Adjacency adjacency = adjacencyOf(variables, couplings);
  CholeskyPattern p;
  p.size = variables;
  const std::vector<int> order = eliminationOrder(adjacency);
  p.position.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    p.position[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  }

  EliminationTree tree(adjacency, order, p.position);
  std::vector<int> column_sizes(n, 1);
  p.row_begin.assign(n + 1, 0);
  for (int r = 0; r < variables; ++r) {
    tree.add(r);
    tree.eachColumn(r, [&](int c) {
      ++column_sizes[static_cast<std::size_t>(c)];
      p.row_column.push_back(c);
    });
    p.row_begin[static_cast<std::size_t>(r) + 1] = static_cast<int>(p.row_column.size());
  }
  fillEntries(column_sizes, &p);
  return p;
}

}  // namespace hyselam_pose_graph

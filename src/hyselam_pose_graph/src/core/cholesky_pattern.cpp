#include "hyselam_pose_graph/cholesky_pattern.hpp"

#include <amd.h>

#include <algorithm>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace hyselam_pose_graph {

namespace {

/// Compressed neighbor lists of a symmetric pattern, without the diagonal and without duplicates.
struct Adjacency {
  std::vector<int> begin, neighbor;
};

Adjacency adjacency(int n, const std::vector<std::pair<int, int>>& couplings) {
  Adjacency a;
  a.begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (const auto& [i, j] : couplings) {
    if (i < 0 || j < 0 || i >= n || j >= n || i == j)
      throw hyselam::InputError("sparsity pattern", "",
                                "a coupling of variables that do not exist or are the same");
    ++a.begin[static_cast<std::size_t>(i) + 1];
    ++a.begin[static_cast<std::size_t>(j) + 1];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) a.begin[i + 1] += a.begin[i];
  std::vector<int> next(a.begin.begin(), a.begin.end() - 1);
  a.neighbor.resize(2 * couplings.size());
  for (const auto& [i, j] : couplings) {
    a.neighbor[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = j;
    a.neighbor[static_cast<std::size_t>(next[static_cast<std::size_t>(j)]++)] = i;
  }
  // Each list sorted, duplicates removed.
  int written = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    const auto first = a.neighbor.begin() + a.begin[i];
    const auto last = a.neighbor.begin() + a.begin[i + 1];
    std::sort(first, last);
    const auto end = std::unique(first, last);
    a.begin[i] = written;
    for (auto it = first; it != end; ++it) a.neighbor[static_cast<std::size_t>(written++)] = *it;
  }
  a.begin[static_cast<std::size_t>(n)] = written;
  a.neighbor.resize(static_cast<std::size_t>(written));
  return a;
}

}  // namespace

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
        parent_(order.size(), -1),
        ancestor_(order.size(), -1),
        mark_(order.size(), -1) {}

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
  void clearMarks() { std::fill(mark_.begin(), mark_.end(), -1); }
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
  std::vector<int> parent_, ancestor_, mark_;
};

/// Fills column_begin, row, row_entry and row_column; row_begin is known.
void fillEntries(const std::vector<int>& column_sizes, EliminationTree* tree, CholeskyPattern* p) {
  const auto n = static_cast<std::size_t>(p->size);
  p->column_begin.assign(n + 1, 0);
  for (std::size_t c = 0; c < n; ++c) {
    p->column_begin[c + 1] = p->column_begin[c] + column_sizes[c];
  }
  p->row.resize(static_cast<std::size_t>(p->column_begin[n]));
  p->row_entry.resize(static_cast<std::size_t>(p->row_begin[n]));
  p->row_column.resize(p->row_entry.size());
  std::vector<int> next(p->column_begin.begin(), p->column_begin.end() - 1);
  tree->clearMarks();
  std::vector<int> columns;
  for (int r = 0; r < p->size; ++r) {
    columns.clear();
    tree->eachColumn(r, [&](int c) { columns.push_back(c); });
    std::sort(columns.begin(), columns.end());
    auto at = static_cast<std::size_t>(p->row_begin[static_cast<std::size_t>(r)]);
    for (const int c : columns) {
      const int entry = next[static_cast<std::size_t>(c)]++;
      p->row[static_cast<std::size_t>(entry)] = r;
      p->row_entry[at] = entry;
      p->row_column[at++] = c;
    }
    p->row[static_cast<std::size_t>(next[static_cast<std::size_t>(r)]++)] = r;
  }
}

}  // namespace

CholeskyPattern analyzePattern(int variables, const std::vector<std::pair<int, int>>& couplings) {
  const auto n = static_cast<std::size_t>(variables);
  const Adjacency a = adjacency(variables, couplings);
  CholeskyPattern p;
  p.size = variables;
  std::vector<int> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<int>(i);
  if (!a.neighbor.empty() &&
      amd_order(variables, a.begin.data(), a.neighbor.data(), order.data(), nullptr, nullptr) < 0) {
    throw std::runtime_error("AMD found no elimination order");
  }
  p.position.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    p.position[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  }

  EliminationTree tree(a, order, p.position);
  std::vector<int> column_sizes(n, 1);
  p.row_begin.assign(n + 1, 0);
  for (int r = 0; r < variables; ++r) {
    tree.add(r);
    int entries = 0;
    tree.eachColumn(r, [&](int c) {
      ++column_sizes[static_cast<std::size_t>(c)];
      ++entries;
    });
    p.row_begin[static_cast<std::size_t>(r) + 1] =
        p.row_begin[static_cast<std::size_t>(r)] + entries;
  }
  fillEntries(column_sizes, &tree, &p);
  return p;
}

}  // namespace hyselam_pose_graph

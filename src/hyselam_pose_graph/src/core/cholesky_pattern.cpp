#include "hyselam_pose_graph/cholesky_pattern.hpp"

#include <amd.h>

#include <algorithm>
#include <stdexcept>

namespace hyselam_pose_graph {

namespace {

/// Compressed neighbour lists of a symmetric pattern, without the diagonal and without doubles.
struct Adjacency {
  std::vector<int> begin, neighbour;
};

Adjacency adjacency(int n, const std::vector<std::pair<int, int>>& couplings) {
  Adjacency a;
  a.begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (const auto& [i, j] : couplings) {
    if (i < 0 || j < 0 || i >= n || j >= n || i == j)
      throw std::invalid_argument("a coupling of variables that are not there or are one");
    ++a.begin[static_cast<std::size_t>(i) + 1];
    ++a.begin[static_cast<std::size_t>(j) + 1];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) a.begin[i + 1] += a.begin[i];
  std::vector<int> next(a.begin.begin(), a.begin.end() - 1);
  a.neighbour.resize(2 * couplings.size());
  for (const auto& [i, j] : couplings) {
    a.neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = j;
    a.neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(j)]++)] = i;
  }
  // Each list sorted, doubles out.
  int written = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    const auto first = a.neighbour.begin() + a.begin[i];
    const auto last = a.neighbour.begin() + a.begin[i + 1];
    std::sort(first, last);
    const auto end = std::unique(first, last);
    a.begin[i] = written;
    for (auto it = first; it != end; ++it) a.neighbour[static_cast<std::size_t>(written++)] = *it;
  }
  a.begin[static_cast<std::size_t>(n)] = written;
  a.neighbour.resize(static_cast<std::size_t>(written));
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

CholeskyPattern analysePattern(int variables, const std::vector<std::pair<int, int>>& couplings) {
  const auto n = static_cast<std::size_t>(variables);
  const Adjacency a = adjacency(variables, couplings);
  CholeskyPattern p;
  p.size = variables;
  std::vector<int> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<int>(i);
  if (!a.neighbour.empty() &&
      amd_order(variables, a.begin.data(), a.neighbour.data(), order.data(), nullptr, nullptr) < 0)
    throw std::runtime_error("AMD found no order of elimination");
  p.position.resize(n);
  for (std::size_t k = 0; k < n; ++k)
    p.position[static_cast<std::size_t>(order[k])] = static_cast<int>(k);

  // Row r of L is what the elimination tree reaches from the neighbours of r that come before it
  // (Liu); parents become known as the rows are gone through.
  std::vector<int> parent(n, -1), ancestor(n, -1), mark(n, -1), count(n, 1);
  p.row_begin.assign(n + 1, 0);
  const auto eachReached = [&](int r, auto&& visit) {
    mark[static_cast<std::size_t>(r)] = r;
    const auto v = static_cast<std::size_t>(order[static_cast<std::size_t>(r)]);
    for (int q = a.begin[v]; q < a.begin[v + 1]; ++q) {
      int c = p.position[static_cast<std::size_t>(a.neighbour[static_cast<std::size_t>(q)])];
      if (c > r) continue;
      for (; mark[static_cast<std::size_t>(c)] != r; c = parent[static_cast<std::size_t>(c)]) {
        mark[static_cast<std::size_t>(c)] = r;
        visit(c);
      }
    }
  };
  for (int r = 0; r < variables; ++r) {
    const auto v = static_cast<std::size_t>(order[static_cast<std::size_t>(r)]);
    for (int q = a.begin[v]; q < a.begin[v + 1]; ++q) {
      int c = p.position[static_cast<std::size_t>(a.neighbour[static_cast<std::size_t>(q)])];
      while (c < r && c >= 0) {  // up to the root, with the path shortened to r
        const int next = ancestor[static_cast<std::size_t>(c)];
        ancestor[static_cast<std::size_t>(c)] = r;
        if (next < 0) parent[static_cast<std::size_t>(c)] = r;
        c = next;
      }
    }
    int entries = 0;
    eachReached(r, [&](int c) {
      ++count[static_cast<std::size_t>(c)];
      ++entries;
    });
    p.row_begin[static_cast<std::size_t>(r) + 1] =
        p.row_begin[static_cast<std::size_t>(r)] + entries;
  }

  p.column_begin.assign(n + 1, 0);
  for (std::size_t c = 0; c < n; ++c) p.column_begin[c + 1] = p.column_begin[c] + count[c];
  p.row.resize(static_cast<std::size_t>(p.column_begin[n]));
  p.row_entry.resize(static_cast<std::size_t>(p.row_begin[n]));
  p.row_column.resize(p.row_entry.size());
  std::vector<int> next(p.column_begin.begin(), p.column_begin.end() - 1);
  std::fill(mark.begin(), mark.end(), -1);
  std::vector<int> columns;
  for (int r = 0; r < variables; ++r) {
    columns.clear();
    eachReached(r, [&](int c) { columns.push_back(c); });
    std::sort(columns.begin(), columns.end());
    auto at = static_cast<std::size_t>(p.row_begin[static_cast<std::size_t>(r)]);
    for (const int c : columns) {
      const int entry = next[static_cast<std::size_t>(c)]++;
      p.row[static_cast<std::size_t>(entry)] = r;
      p.row_entry[at] = entry;
      p.row_column[at++] = c;
    }
    p.row[static_cast<std::size_t>(next[static_cast<std::size_t>(r)]++)] = r;
  }
  return p;
}

}  // namespace hyselam_pose_graph

#include "elimination_order.hpp"

#include <amd.h>

#include <algorithm>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace hyselam_pose_graph {

namespace {

/// Takes variables with at most two neighbors out of a graph.
class ChainElimination {
 public:
  explicit ChainElimination(const Adjacency& adjacency) : lists_(adjacency) {
    const auto n = static_cast<std::size_t>(adjacency.size());
    degree_.resize(n);
    queued_.assign(n, 0);
    order_.reserve(n);
    for (std::size_t v = 0; v < n; ++v) degree_[v] = lists_.begin[v + 1] - lists_.begin[v];
    for (int v = 0; v < adjacency.size(); ++v) enqueue(v);
    // The queue is the order itself: degrees never grow, so that whoever is in it stays there.
    for (std::size_t next = 0; next < order_.size(); ++next) eliminate(order_[next]);
  }

  const std::vector<int>& order() const { return order_; }
  bool eliminated(int v) const { return queued_[static_cast<std::size_t>(v)] != 0; }
  const int* begin(int v) const { return &lists_.neighbor[first(v)]; }
  const int* end(int v) const { return begin(v) + degree_[static_cast<std::size_t>(v)]; }

 private:
  std::size_t first(int v) const {
    return static_cast<std::size_t>(lists_.begin[static_cast<std::size_t>(v)]);
  }
  int* find(int v, int neighbor) {
    int* const list = lists_.neighbor.data() + first(v);
    return std::find(list, list + degree_[static_cast<std::size_t>(v)], neighbor);
  }
  void enqueue(int v) {
    char& queued = queued_[static_cast<std::size_t>(v)];
    if (queued != 0 || degree_[static_cast<std::size_t>(v)] > 2) return;
    queued = 1;
    order_.push_back(v);
  }
  void disconnect(int v, int neighbor) {
    int* const at = find(v, neighbor);
    *at =
        lists_
            .neighbor[first(v) + static_cast<std::size_t>(--degree_[static_cast<std::size_t>(v)])];
    enqueue(v);
  }
  void eliminate(int v) {
    const int degree = degree_[static_cast<std::size_t>(v)];
    const int* const list = lists_.neighbor.data() + first(v);
    if (degree == 0) return;
    const int a = list[0];
    if (degree == 1) return disconnect(a, v);
    const int b = list[1];
    if (find(a, b) != end(a)) {  // coupled already
      disconnect(a, v);
      disconnect(b, v);
    } else {
      *find(a, v) = b;
      *find(b, v) = a;
    }
  }

  Adjacency lists_;
  std::vector<int> degree_;   ///< of each variable, among those that are left
  std::vector<char> queued_;  ///< eliminated, or to be
  std::vector<int> order_;
};

}  // namespace

Adjacency adjacencyOf(int variables, const std::vector<std::pair<int, int>>& couplings) {
  Adjacency a;
  a.begin.assign(static_cast<std::size_t>(variables) + 1, 0);
  for (const auto& [i, j] : couplings) {
    if (i < 0 || j < 0 || i >= variables || j >= variables || i == j)
      throw hyselam::InputError("sparsity pattern", "",
                                "a coupling of variables that do not exist or are the same");
    ++a.begin[static_cast<std::size_t>(i) + 1];
    ++a.begin[static_cast<std::size_t>(j) + 1];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(variables); ++i)
    a.begin[i + 1] += a.begin[i];
  std::vector<int> next(a.begin.begin(), a.begin.end() - 1);
  a.neighbor.resize(2 * couplings.size());
  for (const auto& [i, j] : couplings) {
    a.neighbor[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = j;
    a.neighbor[static_cast<std::size_t>(next[static_cast<std::size_t>(j)]++)] = i;
  }
  // Each list sorted, duplicates removed.
  int written = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(variables); ++i) {
    const auto first = a.neighbor.begin() + a.begin[i];
    const auto last = a.neighbor.begin() + a.begin[i + 1];
    std::sort(first, last);
    const auto end = std::unique(first, last);
    a.begin[i] = written;
    for (auto it = first; it != end; ++it) a.neighbor[static_cast<std::size_t>(written++)] = *it;
  }
  a.begin[static_cast<std::size_t>(variables)] = written;
  a.neighbor.resize(static_cast<std::size_t>(written));
  return a;
}

std::vector<int> eliminationOrder(const Adjacency& adjacency) {
  const ChainElimination chains(adjacency);
  std::vector<int> order = chains.order();
  std::vector<int> rest, number(static_cast<std::size_t>(adjacency.size()), -1);
  for (int v = 0; v < adjacency.size(); ++v) {
    if (chains.eliminated(v)) continue;
    number[static_cast<std::size_t>(v)] = static_cast<int>(rest.size());
    rest.push_back(v);
  }
  if (rest.empty()) return order;
  Adjacency core;
  core.begin.push_back(0);
  for (const int v : rest) {
    for (const int* n = chains.begin(v); n != chains.end(v); ++n)
      core.neighbor.push_back(number[static_cast<std::size_t>(*n)]);
    std::sort(core.neighbor.begin() + core.begin.back(), core.neighbor.end());
    core.begin.push_back(static_cast<int>(core.neighbor.size()));
  }
  std::vector<int> rest_order(rest.size());
  if (amd_order(core.size(), core.begin.data(), core.neighbor.data(), rest_order.data(), nullptr,
                nullptr) < 0) {
    throw std::runtime_error("AMD found no elimination order");
  }
  for (const int i : rest_order) order.push_back(rest[static_cast<std::size_t>(i)]);
  return order;
}

}  // namespace hyselam_pose_graph

#include "agglomeration.hpp"

#include <queue>
#include <utility>
#include <vector>

namespace hyselam_topo {
namespace {

struct Candidate {
  double odds;
  int a, b;  // a < b
  int version_a, version_b;
  bool operator<(const Candidate& o) const {
    if (odds != o.odds) return odds < o.odds;
    return a != o.a ? a > o.a : b > o.b;
  }
};

}  // namespace

void agglomerate(RegionAdjacencyGraph& graph, const OnePlace& odds) {
  std::priority_queue<Candidate> queue;
  std::vector<int> versions(static_cast<std::size_t>(graph.size()) + 1, 0);
  const auto version = [&](int i) -> int& { return versions[static_cast<std::size_t>(i)]; };
  const auto consider = [&](int a, int b, int border) {
    if (graph.border(border).open <= 0.0) return;
    if (a > b) std::swap(a, b);
    const double value = odds(graph, a, b);
    if (value > 0.0) queue.push({value, a, b, version(a), version(b)});
  };
  for (int a = 1; a <= graph.size(); ++a)
    for (const auto& [b, border] : graph.node(a).borders)
      if (a < b) consider(a, b, border);
  while (!queue.empty()) {
    const Candidate best = queue.top();
    queue.pop();
    if (version(best.a) != best.version_a || version(best.b) != best.version_b) continue;
    graph.merge(best.a, best.b);
    ++version(best.a);
    version(best.b) = -1;
    for (const auto& [other, border] : graph.node(best.a).borders) consider(best.a, other, border);
  }
}

}  // namespace hyselam_topo

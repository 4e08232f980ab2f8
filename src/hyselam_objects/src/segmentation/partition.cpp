#include "partition.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <queue>
#include <tuple>

#include "hyselam_common/union_find.hpp"

namespace hyselam_objects {
namespace {

struct Candidate {
  double odds;
  int first, second;
  bool operator<(const Candidate& other) const {  // the last of a priority queue comes first
    return std::tuple(odds, -first, -second) < std::tuple(other.odds, -other.first, -other.second);
  }
};

}  // namespace

std::vector<int> partitionByOdds(int members, const std::vector<PairOdds>& pairs) {
  std::vector<std::map<int, double>> odds(static_cast<std::size_t>(members));
  const auto of = [&](int member) -> std::map<int, double>& {
    return odds[static_cast<std::size_t>(member)];
  };
  for (const PairOdds& pair : pairs) {
    of(pair.first)[pair.second] += pair.odds;
    of(pair.second)[pair.first] += pair.odds;
  }
  std::priority_queue<Candidate> candidates;
  for (int a = 0; a < members; ++a) {
    for (const auto& [b, value] : of(a)) {
      if (a < b && value > 0.0) candidates.push({value, a, b});
    }
  }
  hyselam::UnionFind sets(static_cast<std::size_t>(members));
  while (!candidates.empty()) {
    const Candidate best = candidates.top();
    candidates.pop();
    const int a = best.first, b = best.second;  // b becomes a part of a
    const auto now = of(a).find(b);
    if (now == of(a).end() || now->second != best.odds) continue;  // it has changed since
    sets.unite(a, b);
    of(a).erase(now);
    of(b).erase(a);
    for (const auto& [c, value] : of(b)) {
      of(c).erase(b);
      const double sum = of(a)[c] += value;
      of(c)[a] = sum;
      if (sum > 0.0) candidates.push({sum, std::min(a, c), std::max(a, c)});
    }
    of(b).clear();
  }
  std::vector<int> out(static_cast<std::size_t>(members));
  for (int i = 0; i < members; ++i) out[static_cast<std::size_t>(i)] = sets.find(i);
  return out;
}

}  // namespace hyselam_objects

#include "set_table.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "name_tables.hpp"

namespace hyselam_topo::merging {
namespace {

/// No more vertices than these have all their sets listed.
constexpr std::size_t kMaxListed = 8;
/// The sets of a piece of the free map that has only now become so small are listed.
constexpr std::size_t kExtraPiece = 3;
/// The same of pieces of the whole map, in maps of at most kSmallMap vertices and in larger ones.
constexpr std::size_t kListedPiece = 5;
constexpr std::size_t kListedPieceOfLargeMap = 2;
constexpr std::size_t kSmallMap = 128;

/// Of each vertex those that are ranked below it: by the number of neighbors, then by the area.
std::vector<PlaceSet> rankedBelow(const MatchProblem& problem) {
  std::vector<int> order(problem.vertexCount());
  std::iota(order.begin(), order.end(), 0);
  const auto degree = [&](int v) { return problem.neighbors[at(v)].size(); };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return degree(a) != degree(b) ? degree(a) > degree(b)
                                  : problem.area[at(a)] > problem.area[at(b)];
  });
  std::vector<PlaceSet> ranked_below(problem.vertexCount());
  PlaceSet below;
  for (auto v = order.rbegin(); v != order.rend(); ++v) {
    ranked_below[at(*v)] = below;
    below.insert(at(*v));
  }
  return ranked_below;
}

}  // namespace

SetTable::SetTable(const MatchProblem& problem, bool connected, const PlaceSet& vertices)
    : problem_(problem), connected_(connected), ranked_below_(merging::rankedBelow(problem)) {
  const std::size_t limit =
      problem.vertexCount() <= kSmallMap ? kListedPiece : kListedPieceOfLargeMap;
  vertices.forEach([&](std::size_t v) {
    const int anchor = static_cast<int>(v);
    if (!forEachSet(v, piece(v, vertices), limit, [&](const VertexSet& set) {
          listed_.push_back({set, anchor});
        }))
      unlisted_anchors_.push_back(anchor);
  });
}

PlaceSet SetTable::piece(std::size_t anchor, const PlaceSet& of) const {
  const PlaceSet below = of & ranked_below_[anchor];
  if (!connected_) {
    PlaceSet all = below;
    all.insert(anchor);
    return all;
  }
  PlaceSet reached, front;
  front.insert(anchor);
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem_.neighbors[v]; });
    front = (next & below) - reached;
  }
  return reached;
}

bool SetTable::forEachSet(std::size_t anchor, const PlaceSet& piece, std::size_t limit,
                          const std::function<void(const VertexSet&)>& visit) const {
  std::array<std::size_t, kMaxListed> members{};
  std::size_t count = 0;
  members[count++] = anchor;
  piece.forEach([&](std::size_t v) {
    if (v == anchor) return;
    if (count < kMaxListed) members[count] = v;
    ++count;
  });
  if (count > limit) return false;
  std::array<unsigned, kMaxListed> neighbors{};  // of each member, as bits
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      if (problem_.neighbors[members[i]].contains(members[j])) neighbors[i] |= 1u << j;
  // Subsets as bits; the anchor, bit 0, is in all of them.
  for (unsigned mask = 1; mask < 1u << count; mask += 2) {
    unsigned reached = connected_ ? 1u : mask, front = 1;
    while (reached != mask && front != 0) {
      unsigned next = 0;
      for (std::size_t i = 0; i < count; ++i)
        if ((front >> i & 1u) != 0) next |= neighbors[i];
      front = next & mask & ~reached;
      reached |= front;
    }
    if (reached != mask) continue;
    VertexSet vertices;
    for (std::size_t i = 0; i < count; ++i)
      if ((mask >> i & 1u) != 0) vertices.add(problem_, members[i]);
    visit(vertices);
  }
  return true;
}

void SetTable::listSets(SearchNode& node) const {
  const PlaceSet& available = node.available;
  node.alive.clear();
  for (std::size_t s = 0; s < listed_.size(); ++s)
    if (available.containsAll(listed_[s].vertices.members))
      node.alive.push_back(static_cast<int>(s));
  node.extra.clear();
  node.loose.clear();
  for (const int v : unlisted_anchors_) {
    if (!available.contains(at(v))) continue;
    const PlaceSet reach = piece(at(v), available);
    if (forEachSet(at(v), reach, kExtraPiece, [&](const VertexSet& vertices) {
          node.extra.push_back({vertices, v});
        }))
      continue;
    double area = 0.0;
    PlaceSet neighbors;
    reach.forEach([&](std::size_t w) {
      area += problem_.area[w];
      neighbors |= problem_.neighbors[w];
    });
    node.loose.push_back({v, reach, neighbors, area});
  }
  node.column_of.assign(problem_.vertexCount(), -1);
  int columns = 0;
  available.forEach([&](std::size_t v) { node.column_of[v] = columns++; });
}

}  // namespace hyselam_topo::merging

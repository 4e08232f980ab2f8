// The sets of vertices that names may take: listed where they are few.
#include <algorithm>
#include <array>

#include "exact_search.hpp"

namespace hyselam_topo::merging {
namespace {

/// No more vertices than these have all their sets listed.
constexpr std::size_t kMostListed = 8;
/// The sets of a piece of the free map that has only now become so small are listed.
constexpr std::size_t kExtraPiece = 3;

}  // namespace

PlaceSet ExactSearch::piece(std::size_t anchor, const PlaceSet& of) const {
  const PlaceSet below = of & lower_[anchor];
  if (!params_.connected) {
    PlaceSet all = below;
    all.insert(anchor);
    return all;
  }
  PlaceSet reached, front;
  front.insert(anchor);
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem_.neighbours[v]; });
    front = (next & below) - reached;
  }
  return reached;
}

bool ExactSearch::forEachSet(std::size_t anchor, const PlaceSet& piece, std::size_t limit,
                             const std::function<void(const Vertices&)>& visit) const {
  std::array<std::size_t, kMostListed> members{};
  std::size_t count = 0;
  members[count++] = anchor;
  piece.forEach([&](std::size_t v) {
    if (v == anchor) return;
    if (count < kMostListed) members[count] = v;
    ++count;
  });
  if (count > limit) return false;
  std::array<unsigned, kMostListed> beside{};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      if (problem_.neighbours[members[i]].contains(members[j])) beside[i] |= 1u << j;
  for (unsigned mask = 1; mask < 1u << count; mask += 2) {
    unsigned reached = params_.connected ? 1u : mask, front = 1;
    while (reached != mask && front != 0) {
      unsigned next = 0;
      for (std::size_t i = 0; i < count; ++i)
        if ((front >> i & 1u) != 0) next |= beside[i];
      front = next & mask & ~reached;
      reached |= front;
    }
    if (reached != mask) continue;
    Vertices vertices;
    for (std::size_t i = 0; i < count; ++i)
      if ((mask >> i & 1u) != 0) vertices.add(problem_, members[i]);
    visit(vertices);
  }
  return true;
}

void ExactSearch::listSets(Node* node) const {
  const PlaceSet& available = node->available;
  node->alive.clear();
  for (std::size_t s = 0; s < listed_.size(); ++s)
    if (available.containsAll(listed_[s].vertices.members))
      node->alive.push_back(static_cast<int>(s));
  node->extra.clear();
  node->loose.clear();
  for (const int v : not_always_listed_) {
    if (!available.contains(at(v))) continue;
    const PlaceSet reach = piece(at(v), available);
    if (forEachSet(at(v), reach, kExtraPiece, [&](const Vertices& vertices) {
          node->extra.push_back({vertices, v});
        }))
      continue;
    double area = 0.0;
    PlaceSet around;
    reach.forEach([&](std::size_t w) {
      area += problem_.area[w];
      around |= problem_.neighbours[w];
    });
    node->loose.push_back({v, reach, around, area});
  }
  node->column_of.assign(at(m_), -1);
  int columns = 0;
  available.forEach([&](std::size_t v) { node->column_of[v] = columns++; });
}

void ExactSearch::listOnce() {
  for (std::size_t s = 0; s < problem_.sides.size(); ++s) {
    const auto& told = problem_.sides[s];
    side_between_[at(told.from * n_ + told.to)] = static_cast<int>(s);
    side_between_[at(told.to * n_ + told.from)] = static_cast<int>(s);
  }
  pair_loss_.assign(side_between_.size(), 0.0);
  wall_loss_.assign(side_between_.size(), 0.0);
  led_by_.resize(at(n_));
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const int s = sideBetween(i, j);
      double &apart = pair_loss_[at(i * n_ + j)], &wall = wall_loss_[at(i * n_ + j)];
      apart = terms_.missing_edge + (s >= 0 ? terms_.lostSide(problem_.sides[at(s)]) : 0.0);
      wall = terms_.toldEdge(Contact::kWall) + (s >= 0 ? terms_.throughWall(0.0) : 0.0);
      if (problem_.areJoined(at(i), at(j)) && leads(j, i)) led_by_[at(i)].push_back(j);
    }
  }
  std::vector<double> middles;
  for (const MatchProblem::ToldSide& told : problem_.sides) {
    const auto known = std::find(middles.begin(), middles.end(), told.middle);
    middle_of_.push_back(static_cast<int>(known - middles.begin()));
    if (known == middles.end()) middles.push_back(told.middle);
  }
  middles_ = middles.size();
  const PlaceSet all = free_ - fixed_;
  const std::size_t limit = m_ <= 128 ? 5 : 2;
  all.forEach([&](std::size_t v) {
    const int anchor = static_cast<int>(v);
    if (!forEachSet(v, piece(v, all), limit, [&](const Vertices& vertices) {
          listed_.push_back({vertices, anchor});
        }))
      not_always_listed_.push_back(anchor);
  });
  losses_.resize(1);
  for (int i = 0; i < n_; ++i)
    for (const CandidateSet& set : listed_)
      losses_[0].push_back(problem_.allowed[at(i)].containsAll(set.vertices.members)
                               ? terms_.alone(i, set.vertices)
                               : kNever);
}

}  // namespace hyselam_topo::merging

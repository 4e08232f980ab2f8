#include "partial_losses.hpp"

#include <algorithm>
#include <limits>

namespace hyselam_topo::merging {

bool PartialLosses::isKnown(const FitnessTerms::Clause& clause, int name) const {
  const auto known = [&](int i) { return i < 0 || i == name || state_.isClosed(i); };
  return known(clause.a) && known(clause.b) && known(clause.c);
}

double PartialLosses::relationsLoss(int name, const VertexSet& vertices) const {
  double loss = 0.0;
  const auto of = [&](int i) -> const VertexSet& {
    return i == name ? vertices : state_.vertices(i);
  };
  for (const int number : terms_.clauses_of[at(name)]) {
    const FitnessTerms::Clause& clause = terms_.clauses[at(number)];
    if (isKnown(clause, name)) loss += terms_.clauseLoss(clause, of);
  }
  return loss;
}

bool PartialLosses::mayShareWall(const PlaceSet& a, const PlaceSet& b) const {
  if (!(terms_.closed_door_credit > 0.0)) return false;
  bool any = false;
  a.forEach([&](std::size_t v) { any = any || problem_.across_walls[v].intersects(b); });
  return any;
}

double PartialLosses::exactLoss(int name, const VertexSet& vertices) const {
  double loss = terms_.unaryLoss(name, vertices);
  for (const int k : state_.closed())
    loss += terms_.edgeLoss(name, k, vertices, state_.vertices(k));
  for (const int number : terms_.sides_of[at(name)]) {
    const auto& side = problem_.sides[at(number)];
    const int other = side.from == name ? side.to : side.from;
    if (!state_.isClosed(other)) continue;
    const VertexSet& from = side.from == name ? vertices : state_.vertices(other);
    const VertexSet& to = side.from == name ? state_.vertices(other) : vertices;
    loss += terms_.sideLoss(side, from, to, heading_);
  }
  return loss + relationsLoss(name, vertices);
}

double PartialLosses::emptyLoss(int name, const PartialSet* partial) const {
  const VertexSet none;
  double loss =
      terms_.unaryLoss(name, none) + terms_.absentLoss(Term::kEdge) * state_.closedNeighbors(name);
  for (const int number : terms_.sides_of[at(name)]) {
    const auto& side = problem_.sides[at(number)];
    const int other = side.from == name ? side.to : side.from;
    if (state_.isClosed(other))
      loss += side.from == name ? terms_.absentSideLoss(side, none, state_.vertices(other))
                                : terms_.absentSideLoss(side, state_.vertices(other), none);
    else if (partial != nullptr && partial->name == other)
      loss += terms_.absent_share * terms_.missingSideLoss(side);
  }
  if (partial != nullptr && problem_.areConnected(at(name), at(partial->name)))
    loss += terms_.absentLoss(Term::kEdge);
  return loss + relationsLoss(name, none);
}

double PartialLosses::looseLoss(int name, const LooseAnchor& loose,
                                const PartialSet* partial) const {
  const std::size_t v = at(loose.anchor);
  const PlaceSet& piece = loose.piece;
  if (!problem_.allowed[at(name)].contains(v)) return kNever;
  double loss = 0.0;
  const double described = problem_.attributes[at(name)].area;
  if (described > 0.0) {
    if (problem_.area[v] > described)
      loss += terms_.weight(Term::kArea) * (problem_.area[v] - described) / problem_.area[v];
    else if (loose.area < described)
      loss += terms_.weight(Term::kArea) * (described - loose.area) / described;
  }
  for (const int k : state_.closed()) {
    const PlaceSet& neighbors = state_.vertices(k).neighbors;
    if (problem_.areConnected(at(name), at(k))) {
      if (state_.vertices(k).empty())
        loss += tables_.absentLoss(name, k);
      else if (!neighbors.intersects(piece))
        loss += terms_.closed_door_credit > 0.0 && state_.vertices(k).across_walls.intersects(piece)
                    ? tables_.sharedWallLoss(name, k)
                    : tables_.missingEdgeLoss(name, k);
    } else if (neighbors.contains(v)) {
      loss += terms_.undescribed_edge;
    }
  }
  if (partial != nullptr) {
    const PlaceSet& neighbors = partial->has.neighbors;
    if (!problem_.areConnected(at(name), at(partial->name))) {
      if (neighbors.contains(v)) loss += terms_.undescribed_edge;
    } else if (!neighbors.intersects(piece) && !loose.neighbors.intersects(partial->open)) {
      loss += mayShareWall(piece, partial->has.members | partial->open)
                  ? tables_.sharedWallLoss(name, partial->name)
                  : tables_.missingEdgeLoss(name, partial->name);
    }
  }
  return loss;
}

double PartialLosses::partialAreaLoss(const PartialSet& partial) const {
  const double described = problem_.attributes[at(partial.name)].area;
  if (!(described > 0.0)) return 0.0;
  const double weight = terms_.weight(Term::kArea);
  double smallest = std::numeric_limits<double>::infinity(), all = partial.has.area;
  partial.open.forEach([&](std::size_t v) {
    smallest = std::min(smallest, problem_.area[v]);
    all += problem_.area[v];
  });
  const double next = partial.has.area + smallest;
  const auto over = [&](double a) { return (a - described) / a; };
  if (partial.has.area >= described) return weight * over(partial.has.area);
  if (all < described) return weight * (described - all) / described;
  if (next > described)
    return weight * std::min((described - partial.has.area) / described, over(next));
  return 0.0;
}

double PartialLosses::addPartialEdges(double loss, const PartialSet& partial) const {
  for (const int k : state_.closed()) {
    const VertexSet& other = state_.vertices(k);
    const bool is_described = problem_.areConnected(at(partial.name), at(k));
    const bool touches = partial.has.touches(other);
    if (other.empty()) {
      if (is_described) loss += terms_.absentLoss(Term::kEdge);
      continue;
    }
    if (!is_described && touches) loss += terms_.undescribed_edge;
    if (is_described && !touches && !other.neighbors.intersects(partial.open)) {
      const bool wall =
          terms_.closed_door_credit > 0.0 &&
          (partial.has.sharesWall(other) || other.across_walls.intersects(partial.open));
      loss += terms_.describedEdgeLoss(wall ? Contact::kWall : Contact::kNone);
    }
  }
  return loss;
}

double PartialLosses::partialSideLoss(const MatchProblem::DescribedSide& side,
                                      const PartialSet& partial, int other) const {
  const VertexSet& v = state_.vertices(other);
  if (v.empty()) return terms_.absent_share * terms_.missingSideLoss(side);
  if (terms_.by_doors) {
    const PlaceSet reach = partial.has.members | partial.open;
    return side.from == other ? terms_.minDoorLoss(side, v.members, reach, heading_)
                              : terms_.minDoorLoss(side, reach, v.members, heading_);
  }
  const double weight = terms_.sideWeight(side);
  if (!v.hasCenter() || !(v.neighbors.intersects(partial.open) || partial.has.touches(v)))
    return weight;
  const BearingInterval seen = bearingTo(v.x(), v.y(), partial);
  const double bearing = side.from == other ? seen.bearing : reverseBearing(seen.bearing);
  return weight * terms_.deviation(side, bearing, {heading_.value, heading_.slack + seen.slack}) /
         kPi;
}

double PartialLosses::partialLoss(const PartialSet& partial) const {
  if (partial.open.empty()) return exactLoss(partial.name, partial.has);
  double loss = partialAreaLoss(partial);
  const int parts = problem_.attributes[at(partial.name)].parts;
  if (parts == 0) loss += terms_.weight(Term::kPiece) * (partial.has.count - 1);
  if (parts > 0 && partial.has.count > parts)
    loss += terms_.weight(Term::kParts) * (partial.has.count - parts) / partial.has.count;
  loss = addPartialEdges(loss, partial);
  for (const int number : terms_.sides_of[at(partial.name)]) {
    const auto& side = problem_.sides[at(number)];
    const int other = side.from == partial.name ? side.to : side.from;
    if (state_.isClosed(other)) loss += partialSideLoss(side, partial, other);
  }
  return loss;
}

PartialSetView PartialLosses::viewOf(const VertexSet& vertices, const PartialSet& partial) const {
  PartialSetView view;
  view.touches = partial.has.neighbors.intersects(vertices.members);
  view.may_touch = view.touches || vertices.neighbors.intersects(partial.open);
  view.may_share_wall =
      terms_.closed_door_credit > 0.0 &&
      (partial.has.sharesWall(vertices) || vertices.across_walls.intersects(partial.open));
  view.has_position = vertices.hasCenter();
  if (terms_.by_doors) view.members = vertices.members;
  if (!terms_.by_doors && view.may_touch && view.has_position &&
      !terms_.sides_of[at(partial.name)].empty())
    view.seen = bearingTo(vertices.x(), vertices.y(), partial);
  return view;
}

}  // namespace hyselam_topo::merging

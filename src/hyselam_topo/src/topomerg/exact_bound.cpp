// What an answer loses at least, given the names that have got their vertices. Each other name
// needs a vertex of its own, the largest of its set, or goes without: the cheapest such choice for
// all of them together is an assignment problem. A name's cost for a vertex is the least of what
// any set with that largest vertex would lose: listed set by set where the free vertices fall apart
// into small pieces, estimated where they do not.
#include <algorithm>
#include <array>
#include <cmath>

#include "exact_search.hpp"

namespace hyselam_topo::merging {
namespace {

/// Pieces of the free map up to this are listed set by set.
constexpr std::size_t kListedPiece = 6;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

double ExactSearch::relationsLoss(int name, const Vertices& vertices) const {
  double loss = 0.0;
  for (const int number : terms_.relations_of[at(name)]) {
    const MatchProblem::Relation& r = problem_.relations[at(number)];
    const auto known = [&](int i) { return i < 0 || i == name || is_closed_[at(i)] != 0; };
    if (!known(r.a) || !known(r.b) || !known(r.c)) continue;
    const auto of = [&](int i) -> const Vertices& { return i == name ? vertices : closed_[at(i)]; };
    loss += terms_.relationLoss(r, of(r.a), of(r.b), r.c >= 0 ? &of(r.c) : nullptr);
  }
  return loss;
}

double ExactSearch::exactLoss(int name, const Vertices& vertices) const {
  double loss = terms_.alone(name, vertices);
  for (const int k : closed_list_) loss += terms_.edge(name, k, vertices.touches(closed_[at(k)]));
  for (const int number : terms_.sides_of[at(name)]) {
    const auto& told = problem_.sides[at(number)];
    const int other = told.from == name ? told.to : told.from;
    if (!is_closed_[at(other)]) continue;
    const Vertices& from = told.from == name ? vertices : closed_[at(other)];
    const Vertices& to = told.from == name ? closed_[at(other)] : vertices;
    loss += terms_.sideLoss(told, from, to, heading_);
  }
  return loss + relationsLoss(name, vertices);
}

void ExactSearch::keepReachable(Growth* growth) const {
  if (!params_.connected) return;
  PlaceSet reached, front = growth->has.around & growth->open;
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem_.neighbours[v]; });
    front = (next & growth->open) - reached;
  }
  growth->open = reached;
}

void ExactSearch::locate(Growth* growth) const {
  if (!growth->has.hasCentre()) {
    growth->radius = std::numeric_limits<double>::infinity();
    return;
  }
  const double x = growth->has.x(), y = growth->has.y();
  // How far the centre can move along each axis: vertices are added while they pull it on.
  struct Pull {
    double offset, weight;
  };
  std::array<Pull, PlaceSet::kCapacity> pulls;
  const auto farthest = [&](double dx, double dy) {
    std::size_t count = 0;
    growth->open.forEach([&](std::size_t v) {
      const double offset = dx * (problem_.x[v] - x) + dy * (problem_.y[v] - y);
      if (offset > 0.0 && problem_.weight[v] > 0.0) pulls[count++] = {offset, problem_.weight[v]};
    });
    std::sort(pulls.begin(), pulls.begin() + static_cast<std::ptrdiff_t>(count),
              [](const Pull& a, const Pull& b) { return a.offset > b.offset; });
    double moment = 0.0, weight = growth->has.weight;
    for (std::size_t k = 0; k < count && pulls[k].offset * weight > moment; ++k) {
      moment += pulls[k].offset * pulls[k].weight;
      weight += pulls[k].weight;
    }
    return moment / weight;
  };
  const double east = farthest(1, 0), west = farthest(-1, 0);
  const double north = farthest(0, 1), south = farthest(0, -1);
  growth->x = x + 0.5 * (east - west);
  growth->y = y + 0.5 * (north - south);
  growth->radius = std::hypot(0.5 * (east + west), 0.5 * (north + south)) * (1.0 + 1e-12);
}

namespace {

/// A side between a place at (px, py) and one within a circle: bearing and how much it may be off.
struct Sight {
  double bearing = 0.0;  ///< from the place to the middle of the circle
  double slack = kPi;
};

Sight sight(double px, double py, const Growth& g) {
  const double dx = g.x - px, dy = g.y - py;
  const double d = std::hypot(dx, dy);
  Sight s;
  if (!(g.radius < d)) return s;
  s.bearing = std::atan2(dy, dx);
  s.slack = g.radius > 0.0 ? std::asin(g.radius / d) + 1e-12 : 0.0;
  return s;
}

double turned(double bearing) {
  return bearing > 0.0 ? bearing - kPi : bearing + kPi;
}

}  // namespace

double ExactSearch::grownLoss(const Growth& g) const {
  if (g.open.empty()) return exactLoss(g.name, g.has);
  double loss = 0.0;
  const MatchProblem::Told& told = problem_.told[at(g.name)];
  if (told.area > 0.0) {
    double smallest = std::numeric_limits<double>::infinity(), all = g.has.area;
    g.open.forEach([&](std::size_t v) {
      smallest = std::min(smallest, problem_.area[v]);
      all += problem_.area[v];
    });
    const double next = g.has.area + smallest;
    const auto over = [&](double a) { return (a - told.area) / a; };
    if (g.has.area >= told.area) {
      loss += terms_.area * over(g.has.area);
    } else if (all < told.area) {
      loss += terms_.area * (told.area - all) / told.area;
    } else if (next > told.area) {
      loss += terms_.area * std::min((told.area - g.has.area) / told.area, over(next));
    }
  }
  if (told.parts > 0 && g.has.count > told.parts)
    loss += terms_.parts * (g.has.count - told.parts) / g.has.count;
  for (const int k : closed_list_) {
    const bool is_told = problem_.areJoined(at(g.name), at(k));
    const bool touches = g.has.touches(closed_[at(k)]);
    if (!is_told && touches) loss += terms_.forgotten_edge;
    if (is_told && !touches && !closed_[at(k)].around.intersects(g.open))
      loss += terms_.missing_edge;
  }
  for (const int number : terms_.sides_of[at(g.name)]) {
    const auto& s = problem_.sides[at(number)];
    const int other = s.from == g.name ? s.to : s.from;
    if (!is_closed_[at(other)]) continue;
    const Vertices& v = closed_[at(other)];
    if (!v.hasCentre() || !(v.around.intersects(g.open) || g.has.touches(v))) {
      loss += terms_.side;
      continue;
    }
    const Sight see = sight(v.x(), v.y(), g);
    const double bearing = s.from == other ? see.bearing : turned(see.bearing);
    loss += terms_.side *
            terms_.deviation(s, bearing, {heading_.value, heading_.slack + see.slack}) / kPi;
  }
  return loss;
}

double ExactSearch::emptyLoss(int name, const Growth* growth) const {
  const Vertices none;
  double loss = terms_.alone(name, none) + terms_.missing_edge * told_closed_[at(name)];
  for (const int number : terms_.sides_of[at(name)]) {
    const auto& s = problem_.sides[at(number)];
    const int other = s.from == name ? s.to : s.from;
    if (is_closed_[at(other)] || (growth != nullptr && growth->name == other)) loss += terms_.side;
  }
  if (growth != nullptr && problem_.areJoined(at(name), at(growth->name)))
    loss += terms_.missing_edge;
  return loss + relationsLoss(name, none);
}

double ExactSearch::candidateLoss(const Node& node, int name, const CandidateSet& set,
                                  const Growth* growth) const {
  const Vertices& v = set.vertices;
  if (!problem_.allowed[at(name)].containsAll(v.members)) return kNever;
  double loss = terms_.alone(name, v) + terms_.missing_edge * told_closed_[at(name)];
  for (int t = set.touch_begin; t < set.touch_end; ++t)
    loss += problem_.areJoined(at(name), at(node.touches[at(t)].name)) ? -terms_.missing_edge
                                                                       : terms_.forgotten_edge;
  if (growth != nullptr) {
    if (problem_.areJoined(at(name), at(growth->name))) {
      if (!set.touches_grown && !set.may_touch_grown) loss += terms_.missing_edge;
    } else if (set.touches_grown) {
      loss += terms_.forgotten_edge;
    }
  }
  for (const int number : terms_.sides_of[at(name)]) {
    const auto& s = problem_.sides[at(number)];
    const int other = s.from == name ? s.to : s.from;
    if (is_closed_[at(other)]) {
      int t = set.touch_begin;
      while (t < set.touch_end && node.touches[at(t)].name != other) ++t;
      if (t == set.touch_end || !v.hasCentre() || !closed_[at(other)].hasCentre()) {
        loss += terms_.side;
        continue;
      }
      const double to_other = node.touches[at(t)].bearing;
      const double bearing = s.from == name ? to_other : turned(to_other);
      loss += terms_.side * terms_.deviation(s, bearing, heading_) / kPi;
    } else if (growth != nullptr && growth->name == other) {
      if (!v.hasCentre() || !(set.touches_grown || set.may_touch_grown)) {
        loss += terms_.side;
        continue;
      }
      const Sight see = sight(v.x(), v.y(), *growth);
      const double bearing = s.from == name ? see.bearing : turned(see.bearing);
      loss += terms_.side *
              terms_.deviation(s, bearing, {heading_.value, heading_.slack + see.slack}) / kPi;
    }
  }
  return terms_.relations_of[at(name)].empty() ? loss : loss + relationsLoss(name, v);
}

double ExactSearch::looseLoss(int name, int vertex, const PlaceSet& component,
                              double component_area, const Growth* growth) const {
  const auto v = at(vertex);
  if (!problem_.allowed[at(name)].contains(v)) return kNever;
  double loss = 0.0;
  const double told = problem_.told[at(name)].area;
  if (told > 0.0) {
    if (problem_.area[v] > told)
      loss += terms_.area * (problem_.area[v] - told) / problem_.area[v];
    else if (component_area < told)
      loss += terms_.area * (told - component_area) / told;
  }
  PlaceSet self;
  self.insert(v);
  const auto side = [&](int other) {
    for (const int number : terms_.sides_of[at(name)]) {
      const auto& s = problem_.sides[at(number)];
      if (s.from == other || s.to == other) return terms_.side;
    }
    return 0.0;
  };
  for (const int k : closed_list_) {
    const PlaceSet& around = closed_[at(k)].around;
    if (problem_.areJoined(at(name), at(k))) {
      if (!around.intersects(component)) loss += terms_.missing_edge + side(k);
    } else if (around.contains(v)) {
      loss += terms_.forgotten_edge;
    }
  }
  if (growth != nullptr) {
    const PlaceSet& around = growth->has.around;
    if (!problem_.areJoined(at(name), at(growth->name))) {
      if (around.contains(v)) loss += terms_.forgotten_edge;
    } else if (!around.intersects(component) && !component.intersects(growth->open)) {
      loss += terms_.missing_edge + side(growth->name);
    }
  }
  return loss;
}

void ExactSearch::addSet(Node* node, const Vertices& vertices, const Growth* growth) {
  CandidateSet set;
  set.vertices = vertices;
  int anchor = -1;
  vertices.members.forEach([&](std::size_t v) {
    if (anchor < 0 || size_rank_[v] < size_rank_[at(anchor)]) anchor = static_cast<int>(v);
  });
  set.anchor = anchor;
  set.touch_begin = static_cast<int>(node->touches.size());
  for (const int k : closed_list_) {
    const Vertices& other = closed_[at(k)];
    if (!other.around.intersects(vertices.members)) continue;
    const bool needed =
        vertices.hasCentre() && other.hasCentre() && !terms_.sides_of[at(k)].empty();
    node->touches.push_back({k, needed ? Terms::bearing(vertices, other) : 0.0});
  }
  set.touch_end = static_cast<int>(node->touches.size());
  if (growth != nullptr) {
    set.touches_grown = growth->has.around.intersects(vertices.members);
    set.may_touch_grown = vertices.around.intersects(growth->open);
  }
  node->sets.push_back(set);
}

void ExactSearch::listSets(Node* node, const PlaceSet& available, const Growth* growth) {
  node->sets.clear();
  node->touches.clear();
  node->loose.assign(at(m_), 0);
  node->pieces.clear();
  PlaceSet rest = available;
  while (!rest.empty()) {
    PlaceSet piece;
    if (params_.connected) {
      PlaceSet front;
      front.insert(rest.first());
      while (!front.empty()) {
        piece |= front;
        PlaceSet next;
        front.forEach([&](std::size_t v) { next |= problem_.neighbours[v]; });
        front = (next & rest) - piece;
      }
    } else {
      piece = rest;
    }
    rest -= piece;
    std::array<std::size_t, kListedPiece> members{};
    std::size_t count = 0;
    double area = 0.0;
    piece.forEach([&](std::size_t v) {
      if (count < kListedPiece) members[count] = v;
      ++count;
      area += problem_.area[v];
    });
    if (count > kListedPiece) {
      piece.forEach([&](std::size_t v) {
        Vertices single;
        single.add(problem_, v);
        addSet(node, single, growth);
        node->loose[v] = 1;
      });
      node->pieces.push_back({piece, area});
      continue;
    }
    std::array<unsigned, kListedPiece> beside{};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j)
        if (problem_.neighbours[members[i]].contains(members[j])) beside[i] |= 1u << j;
    for (unsigned mask = 1; mask < 1u << count; ++mask) {
      if (params_.connected) {
        unsigned reached = mask & (~mask + 1u), front = reached;
        while (front != 0) {
          unsigned next = 0;
          for (std::size_t i = 0; i < count; ++i)
            if ((front >> i & 1u) != 0) next |= beside[i];
          front = next & mask & ~reached;
          reached |= front;
        }
        if (reached != mask) continue;
      }
      Vertices vertices;
      for (std::size_t i = 0; i < count; ++i)
        if ((mask >> i & 1u) != 0) vertices.add(problem_, members[i]);
      addSet(node, vertices, growth);
    }
  }
}

double ExactSearch::bound(Node* node, const Growth* growth) {
  node->base = base_ + (growth != nullptr ? grownLoss(*growth) : 0.0);
  node->bound = node->base;
  node->rows.clear();
  const double enough = 1.0 - solutions_.needed();
  if (node->base > enough) return node->bound;
  node->row_of.assign(at(n_), -1);
  for (int i = 0; i < n_; ++i) {
    if (is_closed_[at(i)] || has_fixed_[at(i)] || (growth != nullptr && growth->name == i))
      continue;
    node->row_of[at(i)] = static_cast<int>(node->rows.size());
    node->rows.push_back(i);
  }
  PlaceSet available = free_ - fixed_;
  if (growth != nullptr) available -= growth->has.members;
  listSets(node, available, growth);

  node->column_of.assign(at(m_), -1);
  int columns = 0;
  available.forEach([&](std::size_t v) { node->column_of[v] = columns++; });
  AssignmentBound& table = node->table;
  table.reset(static_cast<int>(node->rows.size()), columns);
  node->cost.resize(node->rows.size() * node->sets.size());
  double* cost = node->cost.data();
  for (std::size_t r = 0; r < node->rows.size(); ++r) {
    const int row = static_cast<int>(r);
    table.without(row) = emptyLoss(node->rows[r], growth);
    for (const CandidateSet& set : node->sets) {
      *cost = candidateLoss(*node, node->rows[r], set, growth);
      double& least = table.cost(row, node->column_of[at(set.anchor)]);
      least = std::min(least, *cost);
      ++cost;
    }
    for (const Node::Piece& piece : node->pieces) {
      piece.vertices.forEach([&](std::size_t v) {
        double& least = table.cost(row, node->column_of[v]);
        least = std::min(least, looseLoss(node->rows[r], static_cast<int>(v), piece.vertices,
                                          piece.area, growth));
      });
    }
  }
  node->assigned = table.solve(enough - node->base);
  node->bound = node->base + node->assigned;
  return node->bound;
}

}  // namespace hyselam_topo::merging

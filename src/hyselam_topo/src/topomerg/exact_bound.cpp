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

/// No more vertices than these have all their sets listed.
constexpr std::size_t kMostListed = 8;
/// The sets of a piece of the free map that has only now become so small are listed.
constexpr std::size_t kExtraPiece = 3;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

double ExactSearch::relationsLoss(int name, const Vertices& vertices) const {
  double loss = 0.0;
  for (const int number : terms_.clauses_of[at(name)]) {
    const Terms::Clause& r = terms_.clauses[at(number)];
    const auto known = [&](int i) { return i < 0 || i == name || is_closed_[at(i)] != 0; };
    if (!known(r.a) || !known(r.b) || !known(r.c)) continue;
    const auto of = [&](int i) -> const Vertices& { return i == name ? vertices : closed_[at(i)]; };
    loss += terms_.clauseLoss(r, of);
  }
  return loss;
}

double ExactSearch::pairLoss(int i, int j) const {
  const int s = sideBetween(i, j);
  return terms_.missing_edge + (s >= 0 ? terms_.lostSide(problem_.sides[at(s)]) : 0.0);
}

double ExactSearch::wallLoss(int i, int j) const {
  return terms_.toldEdge(Contact::kWall) + (sideBetween(i, j) >= 0 ? terms_.throughWall(0.0) : 0.0);
}

bool ExactSearch::mayShareWall(const PlaceSet& a, const PlaceSet& b) const {
  if (!(terms_.shut_door > 0.0)) return false;
  bool any = false;
  a.forEach([&](std::size_t v) { any = any || problem_.behind[v].intersects(b); });
  return any;
}

double ExactSearch::exactLoss(int name, const Vertices& vertices) const {
  double loss = terms_.alone(name, vertices);
  for (const int k : closed_list_)
    loss += terms_.edge(name, k, terms_.contact(vertices, closed_[at(k)]));
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
    if (is_told && !touches && !closed_[at(k)].around.intersects(g.open)) {
      const bool wall = terms_.shut_door > 0.0 && (g.has.sharesWall(closed_[at(k)]) ||
                                                   closed_[at(k)].behind.intersects(g.open));
      loss += terms_.toldEdge(wall ? Contact::kWall : Contact::kNone);
    }
  }
  for (const int number : terms_.sides_of[at(g.name)]) {
    const auto& s = problem_.sides[at(number)];
    const int other = s.from == g.name ? s.to : s.from;
    if (!is_closed_[at(other)]) continue;
    const Vertices& v = closed_[at(other)];
    if (terms_.by_doors) {
      const PlaceSet reach = g.has.members | g.open;
      loss += s.from == other ? terms_.leastDoorLoss(s, v.members, reach, heading_)
                              : terms_.leastDoorLoss(s, reach, v.members, heading_);
      continue;
    }
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
    if (is_closed_[at(other)] || (growth != nullptr && growth->name == other))
      loss += terms_.lostSide(s);
  }
  if (growth != nullptr && problem_.areJoined(at(name), at(growth->name)))
    loss += terms_.missing_edge;
  return loss + relationsLoss(name, none);
}

GrownView ExactSearch::viewOf(const Vertices& v, const Growth& g) const {
  GrownView view;
  view.touches = g.has.around.intersects(v.members);
  view.may_touch = view.touches || v.around.intersects(g.open);
  view.may_share_wall =
      terms_.shut_door > 0.0 && (g.has.sharesWall(v) || v.behind.intersects(g.open));
  view.placed = v.hasCentre();
  if (terms_.by_doors) view.members = v.members;
  if (!terms_.by_doors && view.may_touch && view.placed && !terms_.sides_of[at(g.name)].empty())
    view.see = sight(v.x(), v.y(), g);
  return view;
}

double ExactSearch::grownPairLoss(int name, const GrownView& view, const Growth& g) const {
  if (!problem_.areJoined(at(name), at(g.name))) return view.touches ? terms_.forgotten_edge : 0.0;
  if (!view.may_touch && !view.may_share_wall) return pairLoss(name, g.name);
  const double edge = view.may_touch ? 0.0 : terms_.toldEdge(Contact::kWall);
  const int number = sideBetween(name, g.name);
  if (number < 0) return edge;
  const auto& told = problem_.sides[at(number)];
  if (terms_.by_doors) {
    const PlaceSet reach = g.has.members | g.open;
    return edge + (told.from == name ? terms_.leastDoorLoss(told, view.members, reach, heading_)
                                     : terms_.leastDoorLoss(told, reach, view.members, heading_));
  }
  if (!view.placed) return terms_.side;
  const Sight& see = view.see;
  const double bearing = told.from == name ? see.bearing : turned(see.bearing);
  return terms_.side *
         terms_.deviation(told, bearing, {heading_.value, heading_.slack + see.slack}) / kPi;
}

double ExactSearch::looseLoss(int name, const LooseAnchor& loose, const Growth* growth) const {
  const std::size_t v = at(loose.anchor);
  const PlaceSet& component = loose.piece;
  if (!problem_.allowed[at(name)].contains(v)) return kNever;
  double loss = 0.0;
  const double told = problem_.told[at(name)].area;
  if (told > 0.0) {
    if (problem_.area[v] > told)
      loss += terms_.area * (problem_.area[v] - told) / problem_.area[v];
    else if (loose.area < told)
      loss += terms_.area * (told - loose.area) / told;
  }
  for (const int k : closed_list_) {
    const PlaceSet& around = closed_[at(k)].around;
    if (problem_.areJoined(at(name), at(k))) {
      if (!around.intersects(component))
        loss += terms_.shut_door > 0.0 && closed_[at(k)].behind.intersects(component)
                    ? wallLoss(name, k)
                    : pairLoss(name, k);
    } else if (around.contains(v)) {
      loss += terms_.forgotten_edge;
    }
  }
  if (growth != nullptr) {
    const PlaceSet& around = growth->has.around;
    if (!problem_.areJoined(at(name), at(growth->name))) {
      if (around.contains(v)) loss += terms_.forgotten_edge;
    } else if (!around.intersects(component) && !loose.around.intersects(growth->open)) {
      loss += mayShareWall(component, growth->has.members | growth->open)
                  ? wallLoss(name, growth->name)
                  : pairLoss(name, growth->name);
    }
  }
  return loss;
}

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

bool ExactSearch::untouched(const Group& group, const Growth* growth) const {
  return std::none_of(group.names.begin(), group.names.end(), [&](int i) {
    return is_closed_[at(i)] || (growth != nullptr && growth->name == i);
  });
}

void ExactSearch::listRows(Node* node, int near, const std::vector<char>& late) const {
  node->rows.clear();
  node->row_of.assign(at(n_), -1);
  // Those first whose losses have just become known: they tell soonest that a node is hopeless.
  const auto turn = [&](int i) {
    if (late[at(i)]) return 2;
    return near >= 0 && problem_.areJoined(at(i), at(near)) ? 0 : 1;
  };
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < n_; ++i) {
      if (is_closed_[at(i)] || has_fixed_[at(i)] || i == near || turn(i) != k) continue;
      node->row_of[at(i)] = static_cast<int>(node->rows.size());
      node->rows.push_back(i);
    }
  }
}

double ExactSearch::bound(Node* node, const Growth* growth) {
  node->base = base_ + (growth != nullptr ? grownLoss(*growth) : 0.0);
  node->bound = node->base;
  node->rows.clear();
  const double enough = 1.0 - solutions_.needed();
  if (node->base > enough) return node->bound;
  node->available = free_ - fixed_;
  if (growth != nullptr) node->available -= growth->has.members;
  listSets(node);
  const std::size_t level = closed_list_.size();
  const int last = level > 0 ? closed_list_.back() : -1;
  // Names of a group of which nothing is known yet lose at least what the group does.
  late_.assign(at(n_), 0);
  double groups = 0.0;
  std::size_t late = 0;
  for (Group& group : *groups_) {
    if (!untouched(group, growth)) continue;
    PlaceSet taken = busy_ - free_;
    if (growth != nullptr) taken |= busy_ & growth->has.members;
    groups += leastOf(&group, taken);
    late += group.names.size();
    for (const int i : group.names) late_[at(i)] = 1;
  }
  listRows(node, growth != nullptr ? growth->name : last, late_);

  const std::size_t alive = node->alive.size();
  contacts_.resize(alive);
  bearings_.resize(alive);
  lonely_.resize(node->setCount());
  for (std::size_t s = 0; s < node->setCount(); ++s) {
    const Vertices& v = setOf(*node, s);
    lonely_[s] = v.around.intersects(node->available)                             ? 0
                 : terms_.shut_door > 0.0 && v.behind.intersects(node->available) ? 1
                                                                                  : 2;
  }
  if (growth != nullptr) {
    views_.resize(node->setCount());
    for (std::size_t s = 0; s < node->setCount(); ++s) views_[s] = viewOf(setOf(*node, s), *growth);
  }
  if (growth == nullptr && last >= 0) {
    const Vertices& other = closed_[at(last)];
    const bool sides = other.hasCentre() && !terms_.sides_of[at(last)].empty();
    for (std::size_t s = 0; s < alive; ++s) {
      const Vertices& v = setOf(*node, s);
      contacts_[s] = terms_.contact(other, v);
      if (contacts_[s] == Contact::kJoined && sides && v.hasCentre())
        bearings_[s] = Terms::bearing(v, other);
    }
  }
  if (losses_.size() <= level) losses_.resize(level + 1);
  std::vector<double>& losses = losses_[level];
  if (level > 0 && growth == nullptr) losses.resize(losses_[0].size());

  AssignmentBound& table = node->table;
  table.reset(static_cast<int>(node->rows.size()), static_cast<int>(node->available.size()));
  node->cost.resize(node->rows.size() * node->setCount());
  double sum = node->base;
  for (std::size_t r = 0; r < node->rows.size(); ++r) {
    const int row = static_cast<int>(r);
    const int name = node->rows[r];
    if (r + late == node->rows.size()) {
      node->bound = std::max(node->bound, sum + groups);
      if (node->bound > enough) return node->bound;
    }
    double* cost = node->cost.data() + r * node->setCount();
    double* now = losses.data() + at(name) * listed_.size();
    if (growth == nullptr && last >= 0) {
      const double* before = losses_[level - 1].data() + at(name) * listed_.size();
      addLast(*node, name, last, before, now);
    }
    for (std::size_t s = 0; s < alive; ++s) {
      cost[s] = now[node->alive[s]];
    }
    for (std::size_t s = alive; s < node->setCount(); ++s) {
      const Vertices& v = setOf(*node, s);
      cost[s] = problem_.allowed[at(name)].containsAll(v.members) ? exactLoss(name, v) : kNever;
    }
    if (growth != nullptr)
      for (std::size_t s = 0; s < node->setCount(); ++s)
        cost[s] += grownPairLoss(name, views_[s], *growth);
    // What the name loses if it cannot be joined to those that have no vertices yet.
    double waiting = 0.0, by_wall = 0.0;
    for (const int other : node->rows) {
      if (!problem_.areJoined(at(name), at(other)) || !leads(other, name)) continue;
      waiting += pairLoss(name, other);
      by_wall += wallLoss(name, other);
    }
    for (std::size_t s = 0; s < node->setCount(); ++s) {
      if (lonely_[s] != 0) cost[s] += lonely_[s] == 1 ? by_wall : waiting;
      double& least = table.cost(row, node->column_of[at(anchorOf(*node, s))]);
      least = std::min(least, cost[s]);
    }
    for (const LooseAnchor& loose : node->loose)
      table.cost(row, node->column_of[at(loose.anchor)]) = looseLoss(name, loose, growth);
    table.without(row) = emptyLoss(name, growth) + waiting;
    sum += table.addRow(row);
    node->bound = std::max(node->bound, sum);
    if (sum > enough) return node->bound;
  }
  node->table_bound = sum;
  return node->bound;
}

void ExactSearch::addLast(const Node& node, int name, int last, const double* before,
                          double* now) const {
  const std::size_t alive = node.alive.size();
  if (problem_.areJoined(at(name), at(last))) {
    const double apart = pairLoss(name, last);
    const int number = sideBetween(name, last);
    for (std::size_t s = 0; s < alive; ++s) {
      const int set = node.alive[s];
      double loss = apart;
      if (contacts_[s] != Contact::kNone) {
        loss = terms_.toldEdge(contacts_[s]);
        if (number >= 0) {
          const auto& told = problem_.sides[at(number)];
          if (terms_.by_doors) {
            const Vertices& own = listed_[at(set)].vertices;
            const Vertices& other = closed_[at(last)];
            now[set] = before[set] + loss +
                       (told.from == name ? terms_.sideLoss(told, own, other, heading_)
                                          : terms_.sideLoss(told, other, own, heading_));
            continue;
          }
          const bool known = listed_[at(set)].vertices.hasCentre() && closed_[at(last)].hasCentre();
          const double bearing = told.from == name ? bearings_[s] : turned(bearings_[s]);
          loss +=
              known ? terms_.side * terms_.deviation(told, bearing, heading_) / kPi : terms_.side;
        }
      }
      now[set] = before[set] + loss;
    }
  } else {
    for (std::size_t s = 0; s < alive; ++s)
      now[node.alive[s]] =
          before[node.alive[s]] + (contacts_[s] == Contact::kJoined ? terms_.forgotten_edge : 0.0);
  }
  for (const int number : terms_.clauses_of[at(name)]) {
    const Terms::Clause& r = terms_.clauses[at(number)];
    if (r.a != last && r.b != last && r.c != last) continue;
    const auto known = [&](int i) { return i < 0 || i == name || is_closed_[at(i)] != 0; };
    if (!known(r.a) || !known(r.b) || !known(r.c)) continue;
    for (const int set : node.alive) {
      const auto of = [&](int i) -> const Vertices& {
        return i == name ? listed_[at(set)].vertices : closed_[at(i)];
      };
      now[set] += terms_.clauseLoss(r, of);
    }
  }
}

void ExactSearch::listOnce() {
  for (std::size_t s = 0; s < problem_.sides.size(); ++s) {
    const auto& told = problem_.sides[s];
    side_between_[at(told.from * n_ + told.to)] = static_cast<int>(s);
    side_between_[at(told.to * n_ + told.from)] = static_cast<int>(s);
  }
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

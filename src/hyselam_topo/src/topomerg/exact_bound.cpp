// What an answer loses at least, given the names that have got their vertices. Each other name
// needs a vertex of its own, the largest of its set, or goes without: the cheapest such choice for
// all of them together is an assignment problem. A name's cost for a vertex is the least of what
// any set with that largest vertex would lose: listed set by set where the free vertices fall apart
// into small pieces, estimated where they do not.
#include <algorithm>

#include "exact_search.hpp"

namespace hyselam_topo::merging {

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
  columns_.resize(node->setCount());
  sets_ = node->setCount();
  if (terms_.by_doors) door_losses_.assign(2 * middles_ * sets_, -1.0);
  for (std::size_t s = 0; s < node->setCount(); ++s) {
    const Vertices& v = setOf(*node, s);
    columns_[s] = node->column_of[at(anchorOf(*node, s))];
    lonely_[s] = v.around.intersects(node->available)                             ? 0
                 : terms_.shut_door > 0.0 && v.behind.intersects(node->available) ? 1
                                                                                  : 2;
  }
  if (growth != nullptr) {
    views_.resize(node->setCount());
    touch_costs_.resize(node->setCount());
    for (std::size_t s = 0; s < node->setCount(); ++s) {
      views_[s] = viewOf(setOf(*node, s), *growth);
      touch_costs_[s] = views_[s].touches ? terms_.forgotten_edge : 0.0;
    }
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

  hyselam::Assignment& table = node->table;
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
    if (growth != nullptr) addGrowth(name, *growth, cost);
    // What the name loses if it cannot be joined to those that have no vertices yet.
    double waiting = 0.0, by_wall = 0.0;
    for (const int other : led_by_[at(name)]) {
      if (node->row_of[at(other)] < 0) continue;
      waiting += pairLoss(name, other);
      by_wall += wallLoss(name, other);
    }
    for (std::size_t s = 0; s < node->setCount(); ++s) {
      if (lonely_[s] != 0) cost[s] += lonely_[s] == 1 ? by_wall : waiting;
      double& least = table.cost(row, columns_[s]);
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

void ExactSearch::addLast(const Node& node, int name, int last, const double* before, double* now) {
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
            const bool from_set = told.from == name;
            const PlaceSet& from = from_set ? own.members : other.members;
            const PlaceSet& to = from_set ? other.members : own.members;
            const double doors = rememberedDoors(
                number, from_set, s, [&] { return terms_.doorLoss(told, from, to, heading_); });
            now[set] = before[set] + loss + (doors + terms_.rankLoss(told, from, to));
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

}  // namespace hyselam_topo::merging

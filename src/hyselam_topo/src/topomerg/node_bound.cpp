#include "node_bound.hpp"

#include <algorithm>

namespace hyselam_topo::merging {

NodeBound::NodeBound(const MatchProblem& problem, const FitnessTerms& terms,
                     const NameTables& tables, const SetTable& sets, const SearchState& state,
                     const PartialLosses& losses, const NameGroups& groups)
    : problem_(problem),
      terms_(terms),
      tables_(tables),
      sets_(sets),
      state_(state),
      losses_(losses),
      groups_(groups),
      losses_at_level_(1) {
  for (int i = 0; i < tables.nameCount(); ++i)
    for (const CandidateSet& set : sets.listed())
      losses_at_level_[0].push_back(problem.allowed[at(i)].containsAll(set.vertices.members)
                                        ? terms.unaryLoss(i, set.vertices)
                                        : kNever);
}

bool NodeBound::isUntouched(const NameGroup& group, const PartialSet* partial) const {
  return std::none_of(group.names.begin(), group.names.end(), [&](int i) {
    return state_.isClosed(i) || (partial != nullptr && partial->name == i);
  });
}

NodeBound::Untouched NodeBound::boundUntouchedGroups(const PartialSet* partial,
                                                     std::vector<NameGroup>& groups) {
  Untouched all;
  is_untouched_.assign(problem_.nameCount(), 0);
  for (NameGroup& group : groups) {
    if (!isUntouched(group, partial)) continue;
    PlaceSet taken = tables_.hubVertices() - state_.free();
    if (partial != nullptr) taken |= tables_.hubVertices() & partial->has.members;
    all.loss += groups_.minLoss(group, taken, losses_.heading());
    all.names += group.names.size();
    for (const int i : group.names) is_untouched_[at(i)] = 1;
  }
  return all;
}

void NodeBound::listRows(SearchNode& node, int near) const {
  node.rows.clear();
  node.row_of.assign(problem_.nameCount(), -1);
  // Those first whose losses have just become known: they tell soonest that a node can be pruned.
  const auto turn = [&](int i) {
    if (is_untouched_[at(i)]) return 2;
    return near >= 0 && problem_.areConnected(at(i), at(near)) ? 0 : 1;
  };
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < tables_.nameCount(); ++i) {
      if (state_.isClosed(i) || tables_.isConfirmed(i) || i == near || turn(i) != k) continue;
      node.row_of[at(i)] = static_cast<int>(node.rows.size());
      node.rows.push_back(i);
    }
  }
}

void NodeBound::prepareSets(const SearchNode& node) {
  set_count_ = node.setCount();
  contacts_.resize(node.alive.size());
  bearings_.resize(node.alive.size());
  surroundings_.resize(set_count_);
  columns_.resize(set_count_);
  if (terms_.by_doors) door_losses_.assign(2 * tables_.directionCount() * set_count_, -1.0);
  for (std::size_t s = 0; s < set_count_; ++s) {
    const VertexSet& v = sets_.setOf(node, s);
    columns_[s] = node.column_of[at(sets_.anchorOf(node, s))];
    const bool across_walls =
        terms_.closed_door_credit > 0.0 && v.across_walls.intersects(node.available);
    surroundings_[s] = v.neighbors.intersects(node.available) ? kFreeNeighbors
                       : across_walls                         ? kFreeAcrossWalls
                                                              : kNothingFree;
  }
}

void NodeBound::viewPartial(const SearchNode& node, const PartialSet& partial) {
  views_.resize(set_count_);
  touch_costs_.resize(set_count_);
  for (std::size_t s = 0; s < set_count_; ++s) {
    views_[s] = losses_.viewOf(sets_.setOf(node, s), partial);
    touch_costs_[s] = views_[s].touches ? terms_.undescribed_edge : 0.0;
  }
}

void NodeBound::viewLast(const SearchNode& node, int last) {
  const VertexSet& other = state_.vertices(last);
  const bool sides = other.hasCenter() && !terms_.sides_of[at(last)].empty();
  for (std::size_t s = 0; s < node.alive.size(); ++s) {
    const VertexSet& v = sets_.setOf(node, s);
    contacts_[s] = terms_.contact(other, v);
    if (contacts_[s] == Contact::kJoined && sides && v.hasCenter())
      bearings_[s] = FitnessTerms::bearing(v, other);
  }
}

double NodeBound::compute(SearchNode& node, const PartialSet* partial,
                          std::vector<NameGroup>& groups, double max_loss) {
  node.base = state_.loss() + (partial != nullptr ? losses_.partialLoss(*partial) : 0.0);
  node.bound = node.base;
  node.rows.clear();
  if (node.base > max_loss) return node.bound;
  node.available = state_.free() - tables_.confirmedVertices();
  if (partial != nullptr) node.available -= partial->has.members;
  sets_.listSets(node);
  const std::size_t level = state_.closed().size();
  const int last = level > 0 ? state_.closed().back() : -1;
  const Untouched untouched = boundUntouchedGroups(partial, groups);
  listRows(node, partial != nullptr ? partial->name : last);
  prepareSets(node);
  if (partial != nullptr) viewPartial(node, *partial);
  if (partial == nullptr && last >= 0) viewLast(node, last);
  if (losses_at_level_.size() <= level) losses_at_level_.resize(level + 1);
  if (level > 0 && partial == nullptr) losses_at_level_[level].resize(losses_at_level_[0].size());

  node.table.reset(static_cast<int>(node.rows.size()), static_cast<int>(node.available.size()));
  node.cost.resize(node.rows.size() * set_count_);
  double sum = node.base;
  for (std::size_t r = 0; r < node.rows.size(); ++r) {
    // From here on all rows belong to untouched groups, which lose at least what is known of them.
    if (r + untouched.names == node.rows.size()) {
      node.bound = std::max(node.bound, sum + untouched.loss);
      if (node.bound > max_loss) return node.bound;
    }
    sum += fillRow(node, r, partial, last);
    node.bound = std::max(node.bound, sum);
    if (sum > max_loss) return node.bound;
  }
  node.table_bound = sum;
  return node.bound;
}

double NodeBound::fillRow(SearchNode& node, std::size_t r, const PartialSet* partial, int last) {
  const int row = static_cast<int>(r);
  const int name = node.rows[r];
  const std::size_t level = state_.closed().size(), alive = node.alive.size();
  const std::size_t offset = at(name) * sets_.listed().size();
  double* cost = node.cost.data() + r * set_count_;
  double* now = losses_at_level_[level].data() + offset;
  if (partial == nullptr && last >= 0)
    addLast(node, name, last, losses_at_level_[level - 1].data() + offset, now);
  for (std::size_t s = 0; s < alive; ++s) cost[s] = now[node.alive[s]];
  for (std::size_t s = alive; s < set_count_; ++s) {
    const VertexSet& v = sets_.setOf(node, s);
    cost[s] =
        problem_.allowed[at(name)].containsAll(v.members) ? losses_.exactLoss(name, v) : kNever;
  }
  if (partial != nullptr) addPartial(name, *partial, cost);
  const Isolated isolated = isolatedLoss(node, name);
  hyselam::Assignment& table = node.table;
  for (std::size_t s = 0; s < set_count_; ++s) {
    if (surroundings_[s] != kFreeNeighbors)
      cost[s] += surroundings_[s] == kFreeAcrossWalls ? isolated.wall : isolated.missing;
    double& least = table.cost(row, columns_[s]);
    least = std::min(least, cost[s]);
  }
  for (const LooseAnchor& loose : node.loose)
    table.cost(row, node.column_of[at(loose.anchor)]) = losses_.looseLoss(name, loose, partial);
  table.without(row) = losses_.emptyLoss(name, partial) + isolated.absent;
  return table.addRow(row);
}

NodeBound::Isolated NodeBound::isolatedLoss(const SearchNode& node, int name) const {
  Isolated loss;
  for (const int other : tables_.borneEdgesOf(name)) {
    if (node.row_of[at(other)] < 0) continue;
    // The other name may stay without vertices, if that is cheaper.
    const double absent = tables_.absentLoss(name, other);
    loss.missing += std::min(absent, tables_.missingEdgeLoss(name, other));
    loss.wall += std::min(absent, tables_.sharedWallLoss(name, other));
    loss.absent += absent;
  }
  return loss;
}

void NodeBound::addLast(const SearchNode& node, int name, int last, const double* before,
                        double* now) {
  const std::size_t alive = node.alive.size();
  if (state_.vertices(last).empty()) {
    const bool joined = problem_.areConnected(at(name), at(last));
    const double absent = joined ? tables_.absentLoss(name, last) : 0.0;
    for (std::size_t s = 0; s < alive; ++s) now[node.alive[s]] = before[node.alive[s]] + absent;
  } else if (problem_.areConnected(at(name), at(last))) {
    const double missing = tables_.missingEdgeLoss(name, last);
    const int number = tables_.sideBetween(name, last);
    for (std::size_t s = 0; s < alive; ++s) {
      const int set = node.alive[s];
      if (contacts_[s] == Contact::kNone) {
        now[set] = before[set] + missing;
        continue;
      }
      const double edge = terms_.describedEdgeLoss(contacts_[s]);
      now[set] = number < 0 ? before[set] + edge
                            : addLastSide(before[set], edge, number, name, last, s, set);
    }
  } else {
    for (std::size_t s = 0; s < alive; ++s)
      now[node.alive[s]] = before[node.alive[s]] +
                           (contacts_[s] == Contact::kJoined ? terms_.undescribed_edge : 0.0);
  }
  addLastClauses(node, name, last, now);
}

double NodeBound::addLastSide(double before, double edge, int number, int name, int last,
                              std::size_t s, int set) {
  const auto& side = problem_.sides[at(number)];
  const VertexSet& own = sets_.listed()[at(set)].vertices;
  const VertexSet& other = state_.vertices(last);
  const bool from_set = side.from == name;
  if (terms_.by_doors) {
    const PlaceSet& from = from_set ? own.members : other.members;
    const PlaceSet& to = from_set ? other.members : own.members;
    const double doors = cachedDoorLoss(
        number, from_set, s, [&] { return terms_.doorLoss(side, from, to, losses_.heading()); });
    return before + edge + (doors + terms_.rankLoss(side, from, to));
  }
  const double weight = terms_.sideWeight(side);
  if (!own.hasCenter() || !other.hasCenter()) return before + (edge + weight);
  const double bearing = from_set ? bearings_[s] : reverseBearing(bearings_[s]);
  return before + (edge + weight * terms_.deviation(side, bearing, losses_.heading()) / kPi);
}

void NodeBound::addLastClauses(const SearchNode& node, int name, int last, double* now) const {
  for (const int number : terms_.clauses_of[at(name)]) {
    const FitnessTerms::Clause& clause = terms_.clauses[at(number)];
    if (clause.a != last && clause.b != last && clause.c != last) continue;
    if (!losses_.isKnown(clause, name)) continue;
    for (const int set : node.alive) {
      const auto of = [&](int i) -> const VertexSet& {
        return i == name ? sets_.listed()[at(set)].vertices : state_.vertices(i);
      };
      now[set] += terms_.clauseLoss(clause, of);
    }
  }
}

void NodeBound::addPartial(int name, const PartialSet& partial, double* cost) {
  if (!problem_.areConnected(at(name), at(partial.name))) {
    for (std::size_t s = 0; s < set_count_; ++s) cost[s] += touch_costs_[s];
    return;
  }
  for (std::size_t s = 0; s < set_count_; ++s) cost[s] += partialEdgeLoss(name, s, partial);
}

double NodeBound::partialEdgeLoss(int name, std::size_t set, const PartialSet& partial) {
  const PartialSetView& view = views_[set];
  if (!view.may_touch && !view.may_share_wall) return tables_.missingEdgeLoss(name, partial.name);
  const double edge = view.may_touch ? 0.0 : terms_.describedEdgeLoss(Contact::kWall);
  const int number = tables_.sideBetween(name, partial.name);
  if (number < 0) return edge;
  const auto& side = problem_.sides[at(number)];
  const bool from_set = side.from == name;
  if (terms_.by_doors) {
    return edge + cachedDoorLoss(number, from_set, set, [&] {
             const PlaceSet reach = partial.has.members | partial.open;
             return from_set ? terms_.minDoorLoss(side, view.members, reach, losses_.heading())
                             : terms_.minDoorLoss(side, reach, view.members, losses_.heading());
           });
  }
  const double weight = terms_.sideWeight(side);
  if (!view.has_position) return weight;
  const double bearing = from_set ? view.seen.bearing : reverseBearing(view.seen.bearing);
  const Heading heading{losses_.heading().value, losses_.heading().slack + view.seen.slack};
  return weight * terms_.deviation(side, bearing, heading) / kPi;
}

}  // namespace hyselam_topo::merging

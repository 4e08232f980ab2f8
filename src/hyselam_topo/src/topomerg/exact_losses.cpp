// What a name loses with given vertices, with none, and at least with any set of a large piece.
#include "exact_search.hpp"

namespace hyselam_topo::merging {

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

}  // namespace hyselam_topo::merging

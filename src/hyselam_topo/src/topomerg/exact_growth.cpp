// A name that is being built vertex by vertex: what it may still become, and what that loses at
// least.
#include <algorithm>
#include <array>
#include <cmath>

#include "exact_search.hpp"

namespace hyselam_topo::merging {
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

}  // namespace

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

double ExactSearch::grownPairLoss(int name, std::size_t set, const Growth& g) {
  const GrownView& view = views_[set];
  if (!view.may_touch && !view.may_share_wall) return pairLoss(name, g.name);
  const double edge = view.may_touch ? 0.0 : terms_.toldEdge(Contact::kWall);
  const int number = sideBetween(name, g.name);
  if (number < 0) return edge;
  const auto& told = problem_.sides[at(number)];
  if (terms_.by_doors) {
    const bool from_set = told.from == name;
    return edge + rememberedDoors(number, from_set, set, [&] {
             const PlaceSet reach = g.has.members | g.open;
             return from_set ? terms_.leastDoorLoss(told, view.members, reach, heading_)
                             : terms_.leastDoorLoss(told, reach, view.members, heading_);
           });
  }
  if (!view.placed) return terms_.side;
  const Sight& see = view.see;
  const double bearing = told.from == name ? see.bearing : turned(see.bearing);
  return terms_.side *
         terms_.deviation(told, bearing, {heading_.value, heading_.slack + see.slack}) / kPi;
}

void ExactSearch::addGrowth(int name, const Growth& growth, double* cost) {
  if (!problem_.areJoined(at(name), at(growth.name))) {
    for (std::size_t s = 0; s < sets_; ++s) cost[s] += touch_costs_[s];
    return;
  }
  for (std::size_t s = 0; s < sets_; ++s) cost[s] += grownPairLoss(name, s, growth);
}

}  // namespace hyselam_topo::merging

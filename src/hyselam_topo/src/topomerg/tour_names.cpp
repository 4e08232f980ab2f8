#include "hyselam_topo/topomerg/tour_names.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/topomerg/place_words.hpp"

namespace hyselam_topo {
namespace {

/// Sine of the least angle between the way and a door that is beside it.
constexpr double kBeside = 0.5;

struct Opening {
  double x = 0.0, y = 0.0;    ///< its middle
  double dx = 0.0, dy = 0.0;  ///< out of the corridor
};

/// The first door of an edge, or, of one without doors, the line between the middles.
std::optional<Opening> openingOf(const AugmentedTopologicalMap& map, const Edge& edge,
                                 Id corridor) {
  const double out = edge.a == corridor ? 1.0 : -1.0;
  if (!edge.doors.empty()) {
    const Door& door = edge.doors.front();
    return Opening{door.position.x, door.position.y, out * door.normal.x, out * door.normal.y};
  }
  const auto &a = map.findPlace(edge.a)->centre, &b = map.findPlace(edge.b)->centre;
  if (!a || !b) return std::nullopt;
  const double dx = out * (b->x - a->x), dy = out * (b->y - a->y), length = std::hypot(dx, dy);
  if (!(length > 0.0)) return std::nullopt;
  return Opening{0.5 * (a->x + b->x), 0.5 * (a->y + b->y), dx / length, dy / length};
}

}  // namespace

TourDoors doorsAlong(const AugmentedTopologicalMap& map, Id corridor, double heading) {
  if (map.findPlace(corridor) == nullptr)
    throw hyselam::InputError("map", "place " + std::to_string(corridor), "is not there");
  const double cx = std::cos(heading), cy = std::sin(heading);
  TourDoors found;
  for (const Edge& edge : map.edges) {
    if (edge.a != corridor && edge.b != corridor) continue;
    const auto opening = openingOf(map, edge, corridor);
    if (!opening) continue;
    const double to_left = cx * opening->dy - cy * opening->dx;
    if (std::abs(to_left) < kBeside) continue;
    found.slots.push_back({to_left > 0.0, cx * opening->x + cy * opening->y});
    found.places.push_back(edge.a == corridor ? edge.b : edge.a);
  }
  std::vector<std::size_t> order(found.slots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const TourSlot &s = found.slots[a], &t = found.slots[b];
    return s.is_left != t.is_left ? s.is_left : s.along < t.along;
  });
  TourDoors sorted;
  for (const std::size_t at : order) {
    sorted.slots.push_back(found.slots[at]);
    sorted.places.push_back(found.places[at]);
  }
  return sorted;
}

AugmentedTopologicalMap withTourNames(const AugmentedTopologicalMap& map, const TourDoors& doors,
                                      const ToldTour& tour, const TourMatch& match, double least) {
  AugmentedTopologicalMap out = map;
  for (std::size_t slot = 0; slot < doors.places.size(); ++slot) {
    const auto name = match.best[slot];
    if (!name || !tour.names[*name].is_name || match.of(slot, *name) < least) continue;
    std::vector<std::string> words{tour.names[*name].name};
    words.insert(words.end(), tour.names[*name].aliases.begin(), tour.names[*name].aliases.end());
    giveWords(words, false, out.findPlace(doors.places[slot]));
  }
  return out;
}

}  // namespace hyselam_topo

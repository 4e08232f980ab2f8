// Made-up merging problems: a building as a person sees it, what people tell of it, and the map
// that a robot has of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "hyselam_topo/topomerg/topomerg.hpp"

namespace random_matches {

using namespace hyselam_topo;  // NOLINT: only tests and benches include this

/// The same numbers on every machine, unlike the distributions of <random>.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  int whole(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool chance(double p) { return real(0.0, 1.0) < p; }

 private:
  std::mt19937_64 engine_;
};

struct Instance {
  DescribedBuilding building;
  AugmentedTopologicalMap map;
  MatchObserver observer;
  MatchConstraints constraints;
  std::vector<Id> truth;  ///< name of each place of the map; 0: none. Empty: nobody knows
};

inline Place mapPlace(Id id, double x, double y, double area, PlaceKind kind = PlaceKind::kRoom) {
  Place p;
  p.id = id;
  p.kind = kind;
  p.centre = Point3{x, y, 0.0};
  p.area = area;
  return p;
}

inline Edge mapEdge(Id a, Id b) {
  Edge e;
  e.a = std::min(a, b);
  e.b = std::max(a, b);
  return e;
}

/// `bearing` is that through it, from place a of its edge to place b.
inline Door mapDoor(double x, double y, double bearing) {
  Door d;
  d.position = {x, y, 1.0};
  d.normal = {std::cos(bearing), std::sin(bearing), 0.0};
  d.width = 0.9;
  return d;
}

/// Numbers the doors, sorts the rest.
inline void finish(AugmentedTopologicalMap* map) {
  Id id = 0;
  for (Edge& edge : map->edges)
    for (Door& door : edge.doors) door.id = ++id;
  normalize(*map);
}

/// Anything goes: graphs, sizes and sides have little to do with each other.
inline Instance wild(std::uint64_t seed, int names, int places) {
  Dice dice(seed);
  Instance out;
  for (int i = 1; i <= names; ++i) {
    DescribedPlace p;
    p.id = static_cast<Id>(i);
    p.name = "place " + std::to_string(i);
    if (dice.chance(0.5)) p.area = dice.whole(2, 12) * 4.0;
    if (dice.chance(0.15)) p.parts = dice.whole(1, 3);
    if (dice.chance(0.2)) p.kind = dice.chance(0.5) ? PlaceKind::kRoom : PlaceKind::kCorridor;
    out.building.places.push_back(p);
    if (i == 1) continue;
    DescribedConnection c;
    c.to = p.id;
    c.from = static_cast<Id>(dice.whole(1, i - 1));
    c.side = dice.chance(0.7) ? static_cast<Side>(dice.whole(1, 4)) : Side::kUnknown;
    for (const auto& other : out.building.connections)
      c.order += other.from == c.from && other.side == c.side;
    if (dice.chance(0.3)) c.side_certainty = dice.real(0.4, 1.0);
    if (dice.chance(0.3)) c.order_certainty = dice.real(0.4, 1.0);
    if (!dice.chance(0.1)) out.building.connections.push_back(c);
  }
  if (names >= 3 && dice.chance(0.3)) {
    const auto kind = static_cast<RelationKind>(dice.whole(0, 4));
    out.building.relations.push_back(
        {kind, 2, 1, static_cast<Id>(kind == RelationKind::kBetween ? 3 : 0)});
  }
  for (int v = 1; v <= places; ++v) {
    out.map.places.push_back(mapPlace(static_cast<Id>(v), dice.real(0, 12), dice.real(0, 12),
                                      dice.chance(0.03) ? 0.0 : dice.whole(1, 10) * 4.0,
                                      dice.chance(0.3) ? PlaceKind::kCorridor : PlaceKind::kRoom));
    if (v > 1 && !dice.chance(0.05))
      out.map.edges.push_back(mapEdge(static_cast<Id>(dice.whole(1, v - 1)), static_cast<Id>(v)));
  }
  if (dice.chance(0.5))
    for (Edge& edge : out.map.edges)
      for (int k = dice.whole(0, 2); k > 0; --k)
        edge.doors.push_back(mapDoor(dice.real(0, 12), dice.real(0, 12), dice.real(-3.1, 3.1)));
  for (int k = 0; k < places / 3; ++k) {
    const Id a = static_cast<Id>(dice.whole(1, places)), b = static_cast<Id>(dice.whole(1, places));
    if (a != b && out.map.findEdge(a, b) == nullptr) out.map.edges.push_back(mapEdge(a, b));
  }
  finish(&out.map);
  out.building.robot_place = 1;
  if (dice.chance(0.8)) out.observer.place = static_cast<Id>(dice.whole(1, places));
  if (dice.chance(0.75)) out.observer.heading = dice.real(-3.0, 3.0);
  if (dice.chance(0.2))
    out.constraints.excluded.emplace_back(static_cast<Id>(dice.whole(1, places)),
                                          static_cast<Id>(dice.whole(2, std::max(2, names))));
  return out;
}

struct FloorOptions {
  double told_size = 0.6;   ///< as many sizes are told
  double wrong_size = 0.0;  ///< of those, as many are half or twice as large
  double lost_side = 0.0;   ///< connections without a side
  double forgotten = 0.0;   ///< doors between rooms that nobody tells of
  bool know_heading = true;
  bool doors = true;  ///< of the map have a place and a direction
};

/// Corridors with rooms on both sides, told from the robot's corridor outwards; the map has more
/// places than names, because corridors and rooms are in pieces.
inline Instance floor(std::uint64_t seed, int names, int places, const FloorOptions& options = {}) {
  Dice dice(seed);
  Instance out;
  struct Piece {
    double x, y, area;
    Id name;
  };
  std::vector<Piece> pieces;
  std::vector<std::vector<int>> of(static_cast<std::size_t>(names) + 1);
  const auto addPiece = [&](double x, double y, double area, Id name) {
    of[name].push_back(static_cast<int>(pieces.size()));
    pieces.push_back({x, y, area, name});
  };
  const auto connect = [&](int a, int b, double x = 0.0, double y = 0.0, double bearing = 9.0) {
    out.map.edges.push_back(mapEdge(static_cast<Id>(a + 1), static_cast<Id>(b + 1)));
    if (options.doors && bearing < 9.0)
      out.map.edges.back().doors.push_back(mapDoor(x, y, a < b ? bearing : bearing + M_PI));
  };
  const auto tell = [&](Id id, double area, PlaceKind kind) {
    DescribedPlace p;
    p.id = id;
    p.name = (kind == PlaceKind::kCorridor ? "corridor " : "room ") + std::to_string(id);
    if (dice.chance(options.told_size)) {
      p.area = area * dice.real(0.92, 1.08);
      if (dice.chance(options.wrong_size)) p.area = *p.area * (dice.chance(0.5) ? 2.0 : 0.5);
    }
    p.kind = kind;
    out.building.places.push_back(p);
  };
  const auto join = [&](Id from, Id to, Side side) {
    DescribedConnection c;
    c.from = from;
    c.to = to;
    c.side = dice.chance(options.lost_side) ? Side::kUnknown : side;
    for (const auto& other : out.building.connections)
      c.order += other.from == from && other.side == c.side;
    out.building.connections.push_back(c);
  };

  const int corridors = std::max(1, names / 8);
  int spare = places - names;
  int next = corridors + 1;
  for (int k = 0; k < corridors; ++k) {
    // Parallel corridors, one behind the other to the left, all from x = 0.
    const Id corridor = static_cast<Id>(k + 1);
    const double y0 = 16.0 * k;
    const int last = k + 1 == corridors ? names : std::min(names, next + names / corridors - 2);
    const int rooms = last - next + 1;
    const double length = 4.5 * std::max(1, (rooms + 1) / 2);
    tell(corridor, 2.5 * length, PlaceKind::kCorridor);
    const int parts = spare > 0 && dice.chance(0.7) ? 1 + dice.whole(1, std::min(2, spare)) : 1;
    spare -= parts - 1;
    for (int p = 0; p < parts; ++p) {
      addPiece((p + 0.5) * length / parts, y0, 2.5 * length / parts, corridor);
      if (p > 0) connect(static_cast<int>(pieces.size()) - 2, static_cast<int>(pieces.size()) - 1);
    }
    if (k > 0) {
      connect(of[corridor - 1].front(), of[corridor].front(), 0.5, y0 - 1.25, 0.5 * M_PI);
      join(corridor - 1, corridor, Side::kLeft);
    }
    double at[2] = {0.0, 0.0};
    int previous[2] = {-1, -1};
    for (; next <= last; ++next) {
      const int side = at[0] <= at[1] ? 0 : 1;
      const double width = dice.real(2.5, 6.0), depth = dice.real(3.0, 6.0);
      const double x = at[side] + 0.5 * width, y = y0 + (side == 0 ? 1 : -1) * (1.25 + 0.5 * depth);
      at[side] += width;
      const Id room = static_cast<Id>(next);
      tell(room, width * depth, PlaceKind::kRoom);
      join(corridor, room, side == 0 ? Side::kLeft : Side::kRight);
      int hub = of[corridor].front();
      for (const int p : of[corridor])
        if (std::abs(pieces[static_cast<std::size_t>(p)].x - x) <
            std::abs(pieces[static_cast<std::size_t>(hub)].x - x))
          hub = p;
      const int first = static_cast<int>(pieces.size());
      const int left = names - next;
      const bool two = spare > 0 && (dice.chance(0.3) || spare > left);
      if (two) {
        const double share = dice.real(0.3, 0.7);
        addPiece(x - 0.5 * width * (1 - share), y, width * depth * share, room);
        addPiece(x + 0.5 * width * share, y, width * depth * (1 - share), room);
        connect(first, first + 1);
        --spare;
      } else {
        addPiece(x, y, width * depth, room);
      }
      connect(hub, first, x, y0 + (side == 0 ? 1.25 : -1.25), side == 0 ? 0.5 * M_PI : -0.5 * M_PI);
      if (previous[side] >= 0 && dice.chance(options.forgotten)) connect(previous[side], first);
      previous[side] = static_cast<int>(pieces.size()) - 1;
    }
  }
  while (spare-- > 0) {  // the rest is a chain of cupboards behind the last place
    addPiece(pieces.back().x, pieces.back().y - 2.0, 1.5, pieces.back().name);
    connect(static_cast<int>(pieces.size()) - 2, static_cast<int>(pieces.size()) - 1);
  }
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    out.map.places.push_back(mapPlace(
        static_cast<Id>(p + 1), pieces[p].x + dice.real(-0.2, 0.2),
        pieces[p].y + dice.real(-0.2, 0.2), pieces[p].area * dice.real(0.93, 1.02),
        pieces[p].name <= static_cast<Id>(corridors) ? PlaceKind::kCorridor : PlaceKind::kRoom));
    out.truth.push_back(pieces[p].name);
  }
  finish(&out.map);
  std::sort(out.building.places.begin(), out.building.places.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  out.building.robot_place = 1;
  out.observer.place = 1;
  if (options.know_heading) out.observer.heading = 0.0;
  return out;
}

/// Places that no edge joins share walls here and there, wherever they are.
inline void addWalls(std::uint64_t seed, AugmentedTopologicalMap* map) {
  Dice dice(seed ^ 0xA5A5A5A5u);
  for (std::size_t a = 0; a < map->places.size(); ++a) {
    for (std::size_t b = a + 1; b < map->places.size(); ++b) {
      Place &one = map->places[a], &other = map->places[b];
      if (map->findEdge(one.id, other.id) != nullptr || !dice.chance(0.4)) continue;
      const double bearing = dice.real(-3.1, 3.1);
      Wall wall;
      wall.position = {dice.real(0, 12), dice.real(0, 12), 1.0};
      wall.normal = {std::cos(bearing), std::sin(bearing), 0.0};
      wall.length = 2.0;
      wall.id = map->next_wall_id++;
      one.walls.push_back(wall);
      wall.normal = {-wall.normal.x, -wall.normal.y, 0.0};
      wall.id = map->next_wall_id++;
      other.walls.push_back(wall);
    }
  }
}

/// What people say besides: numbers of doors, distances, words for sizes, other floors, relations
/// of every kind, some of them denied; it has little to do with the building.
inline void addWords(std::uint64_t seed, Instance* instance) {
  Dice dice(seed ^ 0x3C3C3C3Cu);
  DescribedBuilding& building = instance->building;
  for (DescribedPlace& place : building.places) {
    if (dice.chance(0.2)) place.size_word = dice.chance(0.5) ? SizeWord::kSmall : SizeWord::kLarge;
    if (dice.chance(0.2)) place.doors = dice.whole(1, 3);
    if (dice.chance(0.1) && place.id != building.robot_place) place.floor = dice.whole(-1, 1);
  }
  for (DescribedConnection& c : building.connections) {
    if (dice.chance(0.3)) c.rank = dice.chance(0.3) ? -dice.whole(1, 2) : dice.whole(1, 3);
    if (dice.chance(0.2)) c.distance = dice.real(0.5, 10.0);
  }
  const int names = static_cast<int>(building.places.size());
  for (int k = names >= 3 ? dice.whole(0, 3) : 0; k > 0; --k) {
    DescribedRelation r;
    r.denied = dice.chance(0.3);
    r.kind = static_cast<RelationKind>(dice.whole(0, r.denied ? 9 : 7));
    const int a = dice.whole(1, names), b = 1 + a % names, c = 1 + b % names;
    r.a = static_cast<Id>(a);
    r.b = static_cast<Id>(b);
    const bool third =
        r.kind == RelationKind::kBetween || (r.kind == RelationKind::kAfter && dice.chance(0.5));
    if (third) r.c = static_cast<Id>(c);
    if (r.kind == RelationKind::kAtSide) r.side = static_cast<Side>(dice.whole(1, 4));
    building.relations.push_back(r);
  }
  // Told from here and there, looking this way and that.
  const auto view = [&dice] {
    return hyselam::Pose2{dice.real(0, 12), dice.real(0, 12), dice.real(-3.1, 3.1)};
  };
  if (dice.chance(0.4)) {
    for (DescribedConnection& c : building.connections)
      if (dice.chance(0.6)) c.seen_from = view();
    for (DescribedRelation& r : building.relations)
      if (dice.chance(0.6)) r.seen_from = view();
  }
  if (dice.chance(0.5))
    instance->observer.position = hyselam::Point2{dice.real(0, 12), dice.real(0, 12)};
}

/// Parameters of any kind but the sizes of the search.
inline void anyWeights(Dice* dice, FitnessParams* fitness) {
  if (dice->chance(0.3)) *fitness = FitnessParams::equation52();
  fitness->undescribed_edge_credit = dice->chance(0.3) ? 0.5 : 0.0;
  if (dice->chance(0.3)) fitness->closed_door_credit = 0.8;
  if (dice->chance(0.3)) fitness->absent_share = dice->real(0.0, 1.0);
  if (dice->chance(0.3)) fitness->vertices = dice->real(0.0, 2.0);
}

inline MatchProblem compile(const Instance& instance) {
  return compileMatch(instance.building, instance.map, instance.observer, instance.constraints);
}

}  // namespace random_matches

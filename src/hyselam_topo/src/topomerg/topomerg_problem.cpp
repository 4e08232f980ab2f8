#include "hyselam_topo/topomerg/topomerg_problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "angles.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/side_angle.hpp"
#include "hyselam_topo/topomerg/shared_walls.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "map_gaps.hpp"

namespace hyselam_topo {
namespace {

using hyselam::InputError;

double areaOf(const Place& place) {
  return place.area > 0.0 ? place.area : std::abs(signedArea(place.outline));
}

class Numbers {
 public:
  Numbers(const std::vector<Id>& ids, const char* what, const char* whose)
      : what_(what), whose_(whose) {
    for (std::size_t k = 0; k < ids.size(); ++k) number_[ids[k]] = static_cast<int>(k);
  }
  int operator()(Id id, const std::string& source) const {
    const auto found = number_.find(id);
    if (found == number_.end())
      throw InputError(source, std::string(what_) + " " + std::to_string(id),
                       std::string("there is no such place in the ") + whose_);
    return found->second;
  }

 private:
  std::map<Id, int> number_;
  const char* what_;
  const char* whose_;
};

/// From the direction through the doors on a side to that in which they are told: forwards along
/// the left and the right, from left to right on the front and back.
double turnOf(Side side) {
  const double sign = side == Side::kRight || side == Side::kBack ? -1.0 : 1.0;
  return sign * -0.5 * hyselam::kPi;
}

/// How far the robot looked to the left of where it looks in the problem.
double viewAngle(const std::optional<hyselam::Pose2>& seen_from, const MatchProblem& problem) {
  return seen_from && problem.heading ? seen_from->theta - *problem.heading : 0.0;
}

std::optional<hyselam::Point2> standOf(const std::optional<hyselam::Pose2>& seen_from,
                                       const std::optional<hyselam::Point2>& otherwise) {
  if (!seen_from) return otherwise;
  return hyselam::Point2{seen_from->x, seen_from->y};
}

/// The view of the last connection that has one, else of the last relation.
std::optional<hyselam::Pose2> lastView(const DescribedBuilding& building) {
  std::optional<hyselam::Pose2> last;
  for (const DescribedRelation& each : building.relations)
    if (each.seen_from) last = each.seen_from;
  for (const DescribedConnection& each : building.connections)
    if (each.seen_from) last = each.seen_from;
  return last;
}

/// As many nats as a side and an order weigh by default (FitnessParams): what is at least so sure
/// counts in full, what is as good as a guess counts nothing.
constexpr double kSureSide = 4.8, kSureOrder = 2.4;

double strengthOf(double certainty, double sure) {
  if (certainty >= 1.0) return 1.0;
  return std::clamp(std::log(certainty / (1.0 - certainty)) / sure, 0.0, 1.0);
}

/// The places on one side of a place, in the described order.
void addRow(const std::vector<const DescribedConnection*>& row, const Numbers& name,
            MatchProblem* out) {
  const Side side = row.front()->side;
  const double count = static_cast<double>(row.size());
  const double turn = turnOf(side);
  // The first is nearest to the back: on the right hand that is the smallest angle. Front and
  // back are described from left to right.
  const double sign = side == Side::kRight || side == Side::kBack ? -1.0 : 1.0;
  const auto before = [](const auto* a, const auto* b) {
    // Where a number was told, the order is that of telling.
    return !a->rank && !b->rank && a->order < b->order;
  };
  const DescribedConnection* previous = nullptr;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const double offset =
        (0.5 * (count - 1.0) - static_cast<double>(k)) * hyselam::kPi / (2 * count);
    int earlier = 0, later = 0;
    for (const DescribedConnection* other : row) {
      earlier += before(other, row[k]);
      later += before(row[k], other);
    }
    const double side_angle = angleOf(side) + viewAngle(row[k]->seen_from, *out);
    out->sides.push_back({name(row[k]->from, "description"), name(row[k]->to, "description"),
                          hyselam::normalizeAngle(side_angle + sign * offset),
                          hyselam::normalizeAngle(side_angle), turn, earlier, later,
                          strengthOf(row[k]->side_certainty, kSureSide)});
    if (row[k]->rank) continue;
    if (previous != nullptr && before(previous, row[k]))
      out->orders.push_back({out->sides.back().from, name(previous->to, "description"),
                             out->sides.back().to, turn,
                             strengthOf(row[k]->order_certainty, kSureOrder)});
    previous = row[k];
  }
}

void addSides(const std::vector<DescribedConnection>& connections, const Numbers& name,
              const std::optional<hyselam::Point2>& position, MatchProblem* out) {
  std::map<std::pair<Id, Side>, std::vector<const DescribedConnection*>> rows;
  for (const DescribedConnection& c : connections)
    if (c.side != Side::kUnknown) rows[{c.from, c.side}].push_back(&c);
  for (auto& [key, row] : rows) {
    std::stable_sort(row.begin(), row.end(),
                     [](const auto* a, const auto* b) { return a->order < b->order; });
    // One row for each way that the robot looked.
    while (!row.empty()) {
      const std::optional<hyselam::Pose2> view = row.front()->seen_from;
      const auto others = std::stable_partition(row.begin(), row.end(), [&](const auto* each) {
        return each->seen_from.has_value() == view.has_value() && lookAlike(each->seen_from, view);
      });
      addRow({row.begin(), others}, name, out);
      row.erase(row.begin(), others);
    }
  }
  for (const DescribedConnection& c : connections) {
    const int from = name(c.from, "description"), to = name(c.to, "description");
    const bool sided = c.side != Side::kUnknown;
    const std::optional<double> turn = sided ? std::optional<double>(turnOf(c.side)) : std::nullopt;
    const double side_angle =
        hyselam::normalizeAngle(angleOf(c.side) + viewAngle(c.seen_from, *out));
    const std::optional<hyselam::Point2> stand = standOf(c.seen_from, position);
    if (c.rank && *c.rank != 0 && sided)
      out->numbers.push_back({from, to, *c.rank, 0.0, turn, side_angle, stand});
    const bool along = c.side == Side::kLeft || c.side == Side::kRight;
    if (c.distance && (*c.distance > 0.0 || along) && stand)
      out->numbers.push_back(
          {from, to, 0, *c.distance, along ? turn : std::nullopt, side_angle, stand});
  }
}

/// Whether the robot stood in the place of the map that has this name for certain.
bool stoodWithin(Id name, const hyselam::Point2& stand, const AugmentedTopologicalMap& map,
                 const std::vector<std::pair<Id, Id>>& confirmed) {
  constexpr double kNear = 0.5;  // [m]
  const auto at = placeAt(map, stand, kNear);
  return at && std::find(confirmed.begin(), confirmed.end(), std::make_pair(at->place, name)) !=
                   confirmed.end();
}

void addRelations(const DescribedBuilding& building, const std::set<Id>& elsewhere,
                  const Numbers& name, const MatchObserver& observer,
                  const AugmentedTopologicalMap& map,
                  const std::vector<std::pair<Id, Id>>& confirmed, MatchProblem* out) {
  for (const DescribedRelation& r : building.relations) {
    if (elsewhere.count(r.a) + elsewhere.count(r.b) > 0 || (r.c != 0 && elsewhere.count(r.c) > 0))
      continue;
    const bool at_side = r.kind == RelationKind::kAtSide;
    if (at_side && (!out->heading || r.side == Side::kUnknown)) continue;
    const bool after = r.kind == RelationKind::kAfter;
    const std::optional<hyselam::Point2> stand = standOf(r.seen_from, observer.position);
    // "On the way from the corridor" of somebody who stands in it is from where he stands.
    const bool from_stand = after && r.c != 0 && stand && stoodWithin(r.c, *stand, map, confirmed);
    const bool third = r.kind == RelationKind::kBetween || (after && r.c != 0 && !from_stand);
    std::optional<double> looked;
    if (after && stand) looked = r.seen_from ? std::optional(r.seen_from->theta) : observer.heading;
    out->relations.push_back(
        {r.kind, name(r.a, "description"), name(r.b, "description"),
         third ? name(r.c, "description") : -1, r.denied,
         at_side ? hyselam::normalizeAngle(angleOf(r.side) + viewAngle(r.seen_from, *out)) : 0.0,
         stand, looked});
  }
}

void addPassages(const AugmentedTopologicalMap& map, const Numbers& vertex, MatchProblem* out) {
  out->passages.resize(out->vertexCount());
  for (const Edge& edge : map.edges) {
    const auto a = static_cast<std::size_t>(vertex(edge.a, "map"));
    const auto b = static_cast<std::size_t>(vertex(edge.b, "map"));
    const auto add = [&](double dx, double dy, double x, double y) {
      const double bearing = std::atan2(dy, dx);
      const double c = std::cos(bearing), s = std::sin(bearing);
      out->passages[a].push_back({b, bearing, c, s, x, y});
      out->passages[b].push_back({a, std::atan2(-dy, -dx), -c, -s, x, y});
    };
    for (const Door& door : edge.doors)
      add(door.normal.x, door.normal.y, door.position.x, door.position.y);
    out->has_doors = out->has_doors || !edge.doors.empty();
    if (edge.doors.empty() && map.findPlace(edge.a)->centre && map.findPlace(edge.b)->centre)
      add(out->x[b] - out->x[a], out->y[b] - out->y[a], 0.5 * (out->x[a] + out->x[b]),
          0.5 * (out->y[a] + out->y[b]));
  }
}

void addWalls(const AugmentedTopologicalMap& map, MatchProblem* out) {
  const std::vector<SharedWall> all = sharedWalls(map);
  if (all.empty()) return;
  out->walls.resize(out->vertexCount());
  out->across_walls.resize(out->vertexCount());
  for (const SharedWall& wall : all) {
    const double c = wall.normal.x, s = wall.normal.y;
    out->walls[wall.a].push_back({wall.b, std::atan2(s, c), c, s, wall.middle.x, wall.middle.y});
    out->walls[wall.b].push_back(
        {wall.a, std::atan2(-s, -c), -c, -s, wall.middle.x, wall.middle.y});
    out->across_walls[wall.a].insert(wall.b);
    out->across_walls[wall.b].insert(wall.a);
  }
}

void addConstraints(const MatchConstraints& constraints, const Numbers& name, const Numbers& vertex,
                    MatchProblem* out) {
  PlaceSet all;
  for (std::size_t v = 0; v < out->vertexCount(); ++v) all.insert(v);
  out->allowed.assign(out->nameCount(), all);
  out->confirmed_name.assign(out->vertexCount(), -1);
  for (const auto& [place, described] : constraints.confirmed) {
    const int v = vertex(place, "constraints");
    const int i = name(described, "constraints");
    int& fixed = out->confirmed_name[static_cast<std::size_t>(v)];
    if (fixed >= 0 && fixed != i)
      throw InputError("constraints", "place " + std::to_string(place),
                       "is confirmed to have two names");
    fixed = i;
  }
  for (const Id place : constraints.unnamed) {
    const auto v = static_cast<std::size_t>(vertex(place, "constraints"));
    for (PlaceSet& allowed : out->allowed) allowed.erase(v);
  }
  for (const auto& [place, described] : constraints.excluded) {
    const auto v = static_cast<std::size_t>(vertex(place, "constraints"));
    out->allowed[static_cast<std::size_t>(name(described, "constraints"))].erase(v);
  }
  for (std::size_t v = 0; v < out->vertexCount(); ++v) {
    if (out->confirmed_name[v] < 0) continue;
    const auto i = static_cast<std::size_t>(out->confirmed_name[v]);
    if (!out->allowed[i].contains(v))
      throw InputError("constraints", "place " + std::to_string(out->vertices[v]),
                       "a name is both confirmed and excluded");
    for (std::size_t j = 0; j < out->nameCount(); ++j)
      if (j != i) out->allowed[j].erase(v);
  }
}

/// The names of the description and the vertices of the map, with their areas and positions.
void addNamesAndVertices(const DescribedBuilding& building, const AugmentedTopologicalMap& map,
                         MatchProblem* out) {
  for (const DescribedPlace& place : building.places) {
    out->names.push_back(place.id);
    double area = place.area.value_or(0.0);
    if (area <= 0.0 && place.length && place.width) area = *place.length * *place.width;
    out->attributes.push_back({area, place.parts.value_or(0), place.kind, place.size_word,
                               place.doors.value_or(0), false, false});
  }
  for (const Place& place : map.places) {
    out->vertices.push_back(place.id);
    out->area.push_back(areaOf(place));
    out->kind.push_back(place.kind);
    out->x.push_back(place.centre ? place.centre->x : 0.0);
    out->y.push_back(place.centre ? place.centre->y : 0.0);
  }
  std::vector<double> rooms;
  for (std::size_t v = 0; v < out->vertexCount(); ++v)
    if (out->kind[v] != PlaceKind::kCorridor && out->area[v] > 0.0) rooms.push_back(out->area[v]);
  std::sort(rooms.begin(), rooms.end());
  if (!rooms.empty()) out->typical_area = rooms[rooms.size() / 2];
  // Large places say where the middle of several is; without all sizes each counts the same.
  const bool weighed =
      std::all_of(out->area.begin(), out->area.end(), [](double a) { return a > 0.0; });
  for (std::size_t v = 0; v < out->vertexCount(); ++v) {
    out->weight.push_back(!map.places[v].centre ? 0.0 : weighed ? out->area[v] : 1.0);
  }
}

/// Names of another floor, unless a place of this map is confirmed to have them. What was told of
/// them does not count.
std::set<Id> takeOutOtherFloors(const DescribedBuilding& building,
                                const MatchConstraints& constraints, MatchProblem* out) {
  std::set<Id> elsewhere;
  for (const DescribedPlace& place : building.places)
    if (place.floor.value_or(0) != 0) elsewhere.insert(place.id);
  for (const auto& [place, name] : constraints.confirmed) elsewhere.erase(name);
  for (std::size_t i = 0; i < out->nameCount(); ++i) {
    if (elsewhere.count(out->names[i]) == 0) continue;
    out->attributes[i] = {};
    out->attributes[i].elsewhere = true;
  }
  return elsewhere;
}

/// Which names are joined, on which side and in which order they lie, and their relations.
void addStatements(const DescribedBuilding& building, const std::set<Id>& elsewhere,
                   const Numbers& name, const MatchObserver& observer,
                   const AugmentedTopologicalMap& map,
                   const std::vector<std::pair<Id, Id>>& confirmed, MatchProblem* out) {
  const std::size_t n = out->nameCount();
  std::vector<DescribedConnection> connections;
  for (const DescribedConnection& c : building.connections)
    if (elsewhere.count(c.from) + elsewhere.count(c.to) == 0) connections.push_back(c);
  out->described_edges.assign(n * n, 0);
  for (const DescribedConnection& c : connections) {
    const auto a = static_cast<std::size_t>(name(c.from, "description"));
    const auto b = static_cast<std::size_t>(name(c.to, "description"));
    out->described_edges[a * n + b] = out->described_edges[b * n + a] = 1;
  }
  addSides(connections, name, observer.position, out);
  addRelations(building, elsewhere, name, observer, map, confirmed, out);
}

}  // namespace

MatchProblem compileMatch(const DescribedBuilding& building, const AugmentedTopologicalMap& map,
                          const MatchObserver& observer, const MatchConstraints& constraints,
                          const std::vector<MatchEvidence>& evidence) {
  checkDescription(building, "description");
  checkMap(map, "map");
  if (building.places.size() > PlaceSet::kCapacity || map.places.size() > PlaceSet::kCapacity)
    throw InputError(building.places.size() > PlaceSet::kCapacity ? "description" : "map", "",
                     "has more than " + std::to_string(PlaceSet::kCapacity) + " places");
  if (observer.heading && !std::isfinite(*observer.heading))
    throw InputError("observer", "heading", "is no number");
  if (observer.position &&
      !(std::isfinite(observer.position->x) && std::isfinite(observer.position->y)))
    throw InputError("observer", "position", "is no number");

  MatchProblem out;
  addNamesAndVertices(building, map, &out);
  const std::size_t n = out.nameCount(), m = out.vertexCount();
  const Numbers name(out.names, "place", "description"), vertex(out.vertices, "place", "map");
  out.neighbors.resize(m);
  for (const Edge& edge : map.edges) {
    const auto a = static_cast<std::size_t>(vertex(edge.a, "map"));
    const auto b = static_cast<std::size_t>(vertex(edge.b, "map"));
    out.neighbors[a].insert(b);
    out.neighbors[b].insert(a);
  }
  addPassages(map, vertex, &out);
  addWalls(map, &out);
  merging::addGaps(map, &out);
  const std::optional<hyselam::Pose2> last_view = lastView(building);
  if (observer.heading) out.heading = hyselam::normalizeAngle(*observer.heading);
  if (!out.heading && last_view) out.heading = hyselam::normalizeAngle(last_view->theta);

  MatchConstraints all = constraints;
  if (observer.place) {
    vertex(*observer.place, "observer");
    if (building.robot_place) all.confirmed.emplace_back(*observer.place, *building.robot_place);
  }
  const std::set<Id> elsewhere = takeOutOtherFloors(building, all, &out);
  addStatements(building, elsewhere, name, observer, map, all.confirmed, &out);
  addConstraints(all, name, vertex, &out);
  for (std::size_t i = 0; i < n; ++i)
    if (out.attributes[i].elsewhere) out.allowed[i] = {};

  for (const MatchEvidence& e : evidence) {
    const auto i = static_cast<std::size_t>(name(e.name, "evidence"));
    const auto v = static_cast<std::size_t>(vertex(e.place, "evidence"));
    if (!(e.value >= 0.0 && e.value <= 1.0))
      throw InputError("evidence", "place " + std::to_string(e.place), "is not within 0 .. 1");
    if (out.evidence.empty()) out.evidence.assign(n * m, 0.0);
    out.evidence[i * m + v] = e.value;
  }
  return out;
}

}  // namespace hyselam_topo

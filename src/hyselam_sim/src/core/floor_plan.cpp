#include "hyselam_sim/floor_plan.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "yaml_map.hpp"

namespace hyselam_sim {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{16} << 20;
constexpr double kMaxTime = 1e7;

std::string entry(const char* list, std::size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

std::string text(Point2 p) {
  std::ostringstream out;
  out << "[" << p.x << ", " << p.y << "]";
  return out.str();
}

bool insideDrawing(const FloorPlan& plan, Point2 p) {
  return p.x >= plan.origin.x && p.y >= plan.origin.y && p.x <= plan.origin.x + plan.size.x &&
         p.y <= plan.origin.y + plan.size.y;
}

void requireInside(const FloorPlan& plan, const YamlMap& map, const std::string& key,
                   const std::vector<Point2>& points) {
  for (const Point2& p : points) {
    if (!insideDrawing(plan, p)) {
      map.fail(key, "the point " + text(p) + " lies outside the drawing (keys 'origin', 'size')");
    }
  }
}

void requireNewName(const YamlMap& map, const std::string& name, std::set<std::string>& seen) {
  if (!name.empty() && !seen.insert(name).second) {
    map.fail("name", "'" + name + "' is used twice");
  }
}

PlanWall readWall(const FloorPlan& plan, const YamlMap& map, double thickness, double height) {
  PlanWall wall;
  wall.name = map.textOr("name", "");
  wall.points = map.points("points", 2);
  wall.closed = map.has("closed") && map.boolean("closed");
  wall.thickness = map.numberOr("thickness", thickness, 0.01, 10.0);
  wall.height = map.numberOr("height", height, 0.01, 100.0);
  requireInside(plan, map, "points", wall.points);
  if (wall.closed && wall.points.size() < 3) {
    map.fail("points", "a closed wall needs at least 3 points");
  }
  for (std::size_t i = 0; i < wall.segmentCount(); ++i) {
    const Segment s = wall.segment(i);
    if (length(s.b - s.a) < 1e-6) map.fail("points", "the point " + text(s.a) + " is repeated");
  }
  return wall;
}

// Finds the wall that the door is in.
void attach(const FloorPlan& plan, const YamlMap& map, PlanDoor& door) {
  constexpr double kReach = 0.05;
  double best = kReach;
  bool found = false;
  Segment wall_segment;
  for (const PlanWall& wall : plan.walls) {
    for (std::size_t i = 0; i < wall.segmentCount(); ++i) {
      const Segment s = wall.segment(i);
      const double d = distance(door.at, s);
      if (d > best || (found && d >= best)) continue;
      best = d;
      found = true;
      wall_segment = s;
    }
  }
  if (!found) map.fail("at", text(door.at) + " is not on the centre line of any wall");
  const double l = length(wall_segment.b - wall_segment.a);
  door.along = (1.0 / l) * (wall_segment.b - wall_segment.a);
  const double middle = dot(door.along, door.at - wall_segment.a);
  door.at = wall_segment.a + middle * door.along;
  if (middle < 0.5 * door.width - 1e-9 || middle > l - 0.5 * door.width + 1e-9) {
    map.fail("width", "the door does not fit into its wall between " + text(wall_segment.a) +
                          " and " + text(wall_segment.b));
  }
}

PlanDoor readDoor(const FloorPlan& plan, const YamlMap& map) {
  PlanDoor door;
  door.name = map.textOr("name", "");
  door.at = map.point("at");
  door.width = map.numberOr("width", 0.9, 0.1, 50.0);
  const std::string swing = map.choice("swing", {"none", "left", "right"}, "none");
  door.swing = swing == "left"    ? PlanDoor::Swing::kLeft
               : swing == "right" ? PlanDoor::Swing::kRight
                                  : PlanDoor::Swing::kNone;
  door.hinge = map.choice("hinge", {"start", "end"}, "start") == "end" ? PlanDoor::Hinge::kEnd
                                                                       : PlanDoor::Hinge::kStart;
  door.initially_open = !map.has("open") || map.boolean("open");
  const std::vector<YAML::Node> changes = map.list("schedule");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const YamlMap change(map.source(), map.pathOf(entry("schedule", i)), changes[i],
                         {"from", "open"});
    const double time = change.number("from", 0.0, kMaxTime);
    if (!door.schedule.empty() && time <= door.schedule.back().time) {
      change.fail("from", "the times of a schedule must increase");
    }
    door.schedule.push_back({time, change.boolean("open")});
  }
  attach(plan, map, door);
  return door;
}

// Key 'box' or key 'polygon'.
Polygon readOutline(const YamlMap& map) {
  if (map.has("box") == map.has("polygon")) {
    map.fail("box", "exactly one of 'box' and 'polygon' must be given");
  }
  if (map.has("polygon")) return map.points("polygon", 3);
  const std::vector<double> v =
      YamlMap::numbersIn(map.source(), map.pathOf("box"), map.child("box"));
  if (v.size() != 4 && v.size() != 5) {
    map.fail("box", "must be [centre x, centre y, length, width] or with an angle in degrees");
  }
  if (!(v[2] > 0.0 && v[3] > 0.0)) map.fail("box", "length and width must be positive");
  const Pose2 pose{v[0], v[1], v.size() == 5 ? hyselam::radians(v[4]) : 0.0};
  const double l = 0.5 * v[2], w = 0.5 * v[3];
  Polygon outline;
  for (const Point2& p : {Point2{-l, -w}, Point2{l, -w}, Point2{l, w}, Point2{-l, w}}) {
    outline.push_back(pose * p);
  }
  return outline;
}

Furniture readFurniture(const FloorPlan& plan, const YamlMap& map) {
  Furniture item;
  item.name = map.textOr("name", "");
  item.height = map.numberOr("height", 0.8, 0.01, 100.0);
  item.outline = readOutline(map);
  requireInside(plan, map, map.has("box") ? "box" : "polygon", item.outline);
  return item;
}

PlanPlace readPlace(const FloorPlan& plan, const YamlMap& map, const std::vector<Solid>& walls) {
  PlanPlace place;
  place.name = map.text("name");
  place.at = map.point("at");
  if (map.has("polygon")) place.outline = map.points("polygon", 3);
  requireInside(plan, map, "at", {place.at});
  requireInside(plan, map, "polygon", place.outline);
  for (const Solid& wall : walls) {
    if (contains(wall.outline, place.at)) {
      map.fail("at", "place '" + place.name + "' lies inside " + describe(plan, wall));
    }
  }
  if (!place.outline.empty() && !contains(place.outline, place.at)) {
    map.fail("polygon", "does not contain the place's own point " + text(place.at));
  }
  return place;
}

Area readArea(const FloorPlan& plan, const YamlMap& map) {
  Area area;
  map.text("kind");  // has no default
  area.kind = map.choice("kind", areaKinds(), "");
  area.outline = readOutline(map);
  requireInside(plan, map, map.has("box") ? "box" : "polygon", area.outline);
  return area;
}

DoorConfiguration readConfiguration(const FloorPlan& plan, const YamlMap& map) {
  DoorConfiguration configuration;
  configuration.name = map.text("name");
  std::vector<std::string> known;
  for (const PlanDoor& door : plan.doors) known.push_back(door.name);
  const std::vector<YAML::Node> open = map.list("open");
  for (std::size_t i = 0; i < open.size(); ++i) {
    const std::string name = open[i].IsScalar() ? open[i].Scalar() : "";
    if (name.empty() || std::find(known.begin(), known.end(), name) == known.end()) {
      YamlMap::failAt(map.source(), map.pathOf(entry("open", i)), open[i],
                      "there is no door '" + name + "'" + suggestion(name, known));
    }
    configuration.open.push_back(name);
  }
  return configuration;
}

// An opening must lead through: no other wall may cross it.
void requirePassable(const FloorPlan& plan, const PlanDoor& door, const YamlMap& map,
                     const std::vector<Solid>& walls) {
  for (const double along : {-0.45, -0.25, 0.0, 0.25, 0.45}) {
    const Point2 p = door.at + (along * door.width) * door.along;
    for (const Solid& wall : walls) {
      if (contains(wall.outline, p))
        map.fail("at", "the opening is crossed by " + describe(plan, wall));
    }
  }
}

/// The doors of the plan, whose walls are there; returns these with the openings cut out.
std::vector<Solid> readDoors(FloorPlan& plan, const YamlMap& map) {
  const std::vector<std::string> keys{"name", "at", "width", "swing", "hinge", "open", "schedule"};
  const std::vector<YAML::Node> doors = map.list("doors");
  std::set<std::string> names;
  for (std::size_t i = 0; i < doors.size(); ++i) {
    const YamlMap m(map.source(), entry("doors", i), doors[i], keys);
    plan.doors.push_back(readDoor(plan, m));
    requireNewName(m, plan.doors.back().name, names);
  }
  std::vector<Solid> solid_walls = wallSolids(plan);
  for (std::size_t i = 0; i < doors.size(); ++i) {
    const YamlMap m(map.source(), entry("doors", i), doors[i], keys);
    requirePassable(plan, plan.doors[i], m, solid_walls);
  }
  return solid_walls;
}

}  // namespace

bool PlanDoor::isOpen(double time) const {
  bool open = initially_open;
  for (const Change& change : schedule) {
    if (change.time > time) break;
    open = change.open;
  }
  return open;
}

const std::vector<std::string>& areaKinds() {
  static const std::vector<std::string> kinds{"bifurcation", "corner", "corridor", "dead-end",
                                              "hall"};
  return kinds;
}

const std::string& FloorPlan::kindAt(Point2 p) const {
  for (const Area& area : areas) {
    if (contains(area.outline, p)) return area.kind;
  }
  return floor_kind;
}

const PlanPlace& FloorPlan::place(const std::string& place_name) const {
  std::vector<std::string> names;
  for (const PlanPlace& candidate : places) {
    if (candidate.name == place_name) return candidate;
    names.push_back(candidate.name);
  }
  throw hyselam::InputError(
      source, "", "there is no place '" + place_name + "'" + suggestion(place_name, names));
}

void FloorPlan::setDoors(const std::string& configuration) {
  std::vector<std::string> names;
  for (const DoorConfiguration& candidate : configurations) {
    names.push_back(candidate.name);
    if (candidate.name != configuration) continue;
    for (PlanDoor& door : doors) {
      door.initially_open = std::find(candidate.open.begin(), candidate.open.end(), door.name) !=
                            candidate.open.end();
      door.schedule.clear();
    }
    return;
  }
  throw hyselam::InputError(source, "",
                            "there is no configuration of doors '" + configuration + "'" +
                                suggestion(configuration, names));
}

double FloorPlan::nextDoorChange(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const PlanDoor& door : doors) {
    for (const PlanDoor::Change& change : door.schedule) {
      if (change.time > time) next = std::min(next, change.time);
    }
  }
  return next;
}

FloorPlan parseFloorPlan(const std::string& content, const std::string& source) {
  const YamlMap map(
      source, "", hyselam::parseYaml(content, source),
      {"plan", "description", "size", "origin", "wall_thickness", "wall_height", "walls", "doors",
       "configurations", "furniture", "places", "inside", "areas", "floor_kind"});
  FloorPlan plan;
  plan.source = source;
  plan.name = map.text("plan");
  plan.description = map.textOr("description", "");
  plan.size = map.point("size");
  if (!(plan.size.x > 0.0 && plan.size.y > 0.0)) map.fail("size", "both sides must be positive");
  if (map.has("origin")) plan.origin = map.point("origin");
  const double thickness = map.numberOr("wall_thickness", 0.2, 0.01, 10.0);
  const double height = map.numberOr("wall_height", 2.5, 0.01, 100.0);

  std::set<std::string> names;
  const std::vector<YAML::Node> walls = map.list("walls");
  if (walls.empty()) map.fail("walls", "there must be at least one wall");
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const YamlMap m(source, entry("walls", i), walls[i],
                    {"name", "points", "closed", "thickness", "height"});
    plan.walls.push_back(readWall(plan, m, thickness, height));
    requireNewName(m, plan.walls.back().name, names);
  }

  const std::vector<Solid> solid_walls = readDoors(plan, map);

  names.clear();
  const std::vector<YAML::Node> configurations = map.list("configurations");
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const YamlMap m(source, entry("configurations", i), configurations[i], {"name", "open"});
    plan.configurations.push_back(readConfiguration(plan, m));
    requireNewName(m, plan.configurations.back().name, names);
  }

  const std::vector<YAML::Node> furniture = map.list("furniture");
  for (std::size_t i = 0; i < furniture.size(); ++i) {
    const YamlMap m(source, entry("furniture", i), furniture[i],
                    {"name", "box", "polygon", "height"});
    plan.furniture.push_back(readFurniture(plan, m));
  }

  names.clear();
  const std::vector<YAML::Node> places = map.list("places");
  for (std::size_t i = 0; i < places.size(); ++i) {
    const YamlMap m(source, entry("places", i), places[i], {"name", "at", "polygon"});
    plan.places.push_back(readPlace(plan, m, solid_walls));
    requireNewName(m, plan.places.back().name, names);
  }

  if (map.has("floor_kind")) plan.floor_kind = map.choice("floor_kind", areaKinds(), "");
  const std::vector<YAML::Node> areas = map.list("areas");
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const YamlMap m(source, entry("areas", i), areas[i], {"kind", "box", "polygon"});
    plan.areas.push_back(readArea(plan, m));
  }

  if (map.has("inside")) {
    plan.inside = map.points("inside", 1);
    requireInside(plan, map, "inside", plan.inside);
  }
  return plan;
}

FloorPlan loadFloorPlan(const std::string& path) {
  return parseFloorPlan(hyselam::readTextFile(path, kMaxFileBytes), path);
}

}  // namespace hyselam_sim

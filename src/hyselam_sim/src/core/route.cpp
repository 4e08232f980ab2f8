#include "hyselam_sim/route.hpp"

#include <cmath>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "yaml_map.hpp"

namespace hyselam_sim {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxSteps = 100000;
constexpr double kMaxTime = 1e7;

std::string whereOf(const std::string& path, const YAML::Node& node) {
  return "line " + std::to_string(node.Mark().line + 1) + ", key '" + path + "'";
}

// A place's name or [x, y].
Spot readSpot(const std::string& source, const std::string& path, const YAML::Node& node) {
  Spot spot;
  if (node.IsScalar() && !node.Scalar().empty()) {
    spot.place = node.Scalar();
    return spot;
  }
  const std::vector<double> xy =
      node.IsSequence() ? YamlMap::numbersIn(source, path, node) : std::vector<double>{};
  if (xy.size() != 2)
    YamlMap::failAt(source, path, node, "must be a place's name or a point [x, y]");
  spot.point = {xy[0], xy[1]};
  return spot;
}

std::optional<double> readHeading(const YamlMap& map) {
  if (!map.has("heading")) return std::nullopt;
  return hyselam::normalizeAngle(hyselam::radians(map.number("heading", -360.0, 360.0)));
}

void readSteps(const std::string& source, const std::string& path, const YAML::Node& list,
               std::vector<RouteStep>& out) {
  if (!list.IsSequence()) YamlMap::failAt(source, path, list, "must be a list of steps");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const YAML::Node node = list[i];
    const std::string here = path + "[" + std::to_string(i) + "]";
    if (out.size() >= kMaxSteps)
      YamlMap::failAt(source, here, node, "the route has too many steps");
    RouteStep step;
    step.where = whereOf(here, node);
    if (!node.IsMap()) {
      step.spot = readSpot(source, here, node);
      out.push_back(step);
      continue;
    }
    const YamlMap map(source, here, node,
                      {"go", "teleport", "heading", "wait", "doors", "repeat", "steps"});
    if (map.has("go") + map.has("teleport") + map.has("wait") + map.has("repeat") != 1) {
      YamlMap::failAt(source, here, node,
                      "must have exactly one of 'go', 'teleport', 'wait' and 'repeat'");
    }
    if (map.has("heading") && !map.has("teleport")) {
      map.fail("heading", "goes with 'teleport' only");
    }
    if (map.has("steps") != map.has("repeat")) map.fail("steps", "goes with 'repeat'");
    if (map.has("repeat")) {
      if (map.has("doors")) map.fail("doors", "goes with 'go', 'teleport' and 'wait' only");
      const double times = map.number("repeat", 1, kMaxSteps);
      if (times != std::floor(times)) map.fail("repeat", "must be a whole number");
      for (int k = 0; k < static_cast<int>(times); ++k) {
        readSteps(source, map.pathOf("steps"), map.child("steps"), out);
      }
      continue;
    }
    step.doors = map.textOr("doors", "");
    if (map.has("wait")) {
      step.kind = RouteStep::Kind::kWait;
      step.seconds = map.number("wait", 0.0, kMaxTime);
    } else if (map.has("teleport")) {
      step.kind = RouteStep::Kind::kTeleport;
      step.spot = readSpot(source, map.pathOf("teleport"), map.child("teleport"));
      step.spot.heading = readHeading(map);
    } else {
      step.spot = readSpot(source, map.pathOf("go"), map.child("go"));
    }
    out.push_back(step);
  }
}

Person readPerson(const YamlMap& map) {
  Person person;
  person.name = map.textOr("name", "");
  person.points = map.points("points", 2);
  const std::string mode = map.choice("mode", {"once", "patrol", "loop"}, "patrol");
  person.mode = mode == "once"   ? Person::Mode::kOnce
                : mode == "loop" ? Person::Mode::kLoop
                                 : Person::Mode::kPatrol;
  person.speed = map.numberOr("speed", 1.2, 0.01, 10.0);
  person.radius = map.numberOr("radius", 0.25, 0.01, 2.0);
  person.start_time = map.numberOr("from", 0.0, 0.0, kMaxTime);
  if (polylineLength(person.points) < 1e-6) map.fail("points", "are all the same");
  return person;
}

}  // namespace

Point2 makeRoom(Point2 person, Point2 robot) {
  constexpr double kPersonalSpace = 0.75;  // [m]
  const Point2 off = person - robot;
  const double d = length(off);
  if (d >= kPersonalSpace) return person;
  if (d < 1e-9) return robot + Point2{0.0, kPersonalSpace};
  return robot + (kPersonalSpace / d) * off;
}

std::optional<Point2> Person::at(double time) const {
  const double total =
      polylineLength(points) + (mode == Mode::kLoop ? length(points.front() - points.back()) : 0.0);
  double way = speed * (time - start_time);
  if (way < 0.0) {
    if (mode == Mode::kOnce) return std::nullopt;
    return points.front();
  }
  switch (mode) {
    case Mode::kOnce:
      if (way > total) return std::nullopt;
      break;
    case Mode::kPatrol:
      way = std::fmod(way, 2.0 * total);
      if (way > total) way = 2.0 * total - way;
      break;
    case Mode::kLoop:
      way = std::fmod(way, total);
      break;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point2 a = points[i], b = points[(i + 1) % points.size()];
    const double l = length(b - a);
    if (way <= l && l > 0.0) return a + (way / l) * (b - a);
    way -= l;
  }
  return points.back();
}

Route parseRoute(const std::string& content, const std::string& source) {
  const YamlMap map(
      source, "", hyselam::parseYaml(content, source),
      {"route", "plan", "description", "start", "doors", "speed", "direct", "steps", "people"});
  Route route;
  route.source = source;
  route.name = map.text("route");
  route.plan = map.textOr("plan", "");
  route.description = map.textOr("description", "");
  const YAML::Node start = map.child("start");
  if (start.IsMap()) {
    const YamlMap m(source, "start", start, {"at", "heading"});
    route.start = readSpot(source, "start.at", m.child("at"));
    route.start.heading = readHeading(m);
  } else {
    route.start = readSpot(source, "start", start);
  }
  route.doors = map.textOr("doors", "");
  route.direct = map.has("direct") && map.boolean("direct");
  if (map.has("speed")) route.speed = map.number("speed", 0.05, 1.4);
  readSteps(source, "steps", map.child("steps"), route.steps);
  if (route.steps.empty()) map.fail("steps", "there must be at least one step");
  const std::vector<YAML::Node> people = map.list("people");
  for (std::size_t i = 0; i < people.size(); ++i) {
    const YamlMap m(source, "people[" + std::to_string(i) + "]", people[i],
                    {"name", "points", "mode", "speed", "radius", "from"});
    route.people.push_back(readPerson(m));
  }
  return route;
}

Route loadRoute(const std::string& path) {
  return parseRoute(hyselam::readTextFile(path, kMaxFileBytes), path);
}

}  // namespace hyselam_sim

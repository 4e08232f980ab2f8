// What the robot does in a run, and who walks about meanwhile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_sim {

/// A place by name or a point; `heading` in radians where one was given.
struct Spot {
  std::string place;  ///< empty: use `point`
  Point2 point;
  std::optional<double> heading;
};

struct RouteStep {
  enum class Kind {
    kGo,        ///< to a place by the cheapest path, to a point straight on
    kTeleport,  ///< the robot is carried away: its pose jumps, odometry notices nothing
    kWait       ///< stands still
  };
  Kind kind = Kind::kGo;
  Spot spot;
  double seconds = 0.0;  ///< of kWait
  std::string doors;     ///< configuration that the plan's doors take on before; may be empty
  std::string where;     ///< "line 7, key 'steps[2]'", for messages
};

/// Someone who walks along a polyline at a steady pace.
struct Person {
  enum class Mode {
    kOnce,    ///< appears at `start_time`, walks to the end, is gone
    kPatrol,  ///< to and fro
    kLoop     ///< round and round
  };
  std::string name;
  std::vector<Point2> points;  ///< at least two
  Mode mode = Mode::kPatrol;
  double speed = 1.2;       ///< [m/s]
  double radius = 0.25;     ///< [m]
  double start_time = 0.0;  ///< [s] since the start of the run; patrols and loops stand until then

  /// Where the person is `time` seconds after the start of the run; nothing if not there.
  std::optional<Point2> at(double time) const;
};

/// People make room for the robot: where someone stands who would otherwise be at `person`.
Point2 makeRoom(Point2 person, Point2 robot);

struct Route {
  std::string name;
  std::string source;  ///< file, for messages
  std::string plan;    ///< name of the plan it belongs to; may be empty
  std::string description;
  Spot start;
  std::string doors;  ///< configuration of the plan's doors at the start; empty: as the plan says
  /// A leg between places must not pass another place (what comes nearer to one than 1.2 m).
  bool direct = false;
  std::optional<double> speed;  ///< cruising speed [m/s] instead of the default
  std::vector<RouteStep> steps;
  std::vector<Person> people;
};

/// Reads a route; README.md describes the format. @throws hyselam::InputError naming file, line,
/// key and reason.
Route loadRoute(const std::string& path);
Route parseRoute(const std::string& text, const std::string& source);

}  // namespace hyselam_sim

// A building as a person would sketch it: walls, doors, furniture and the names of its places.
//
// All coordinates are in the plan frame, which is also the `map` frame: x right, y up, metres.
// Heights are kept for sensors that look up and down; the planar laser does not use them.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "hyselam_sim/geometry.hpp"

namespace hyselam_sim {

/// A wall along a polyline (its centre line).
struct PlanWall {
  std::string name;            ///< for messages; may be empty
  std::vector<Point2> points;  ///< at least two
  bool closed = false;         ///< the last point connects to the first
  double thickness = 0.2;      ///< [m], > 0
  double height = 2.5;         ///< [m], > 0

  std::size_t segmentCount() const { return closed ? points.size() : points.size() - 1; }
  Segment segment(std::size_t i) const { return {points[i], points[(i + 1) % points.size()]}; }
};

/// An opening in a wall with a leaf that is shut or open by the clock.
struct PlanDoor {
  /// Where an open leaf stands, seen along the wall's direction. kNone: nothing is in the way (a
  /// sliding door, or a mere gap if it is always open).
  enum class Swing { kNone, kLeft, kRight };
  /// Which end of the opening carries the hinge, seen along the wall's direction.
  enum class Hinge { kStart, kEnd };
  struct Change {
    double time = 0.0;  ///< [s] since the start of the run, >= 0
    bool open = true;
  };

  std::string name;
  Point2 at;           ///< middle of the opening, on a wall's centre line
  double width = 0.9;  ///< [m], > 0
  Swing swing = Swing::kNone;
  Hinge hinge = Hinge::kStart;
  bool initially_open = true;
  std::vector<Change> schedule;  ///< strictly increasing times
  Point2 along{1.0, 0.0};        ///< unit vector of the wall's direction (set by the loader)

  bool isOpen(double time) const;
};

/// A state of all doors under a name that routes use.
struct DoorConfiguration {
  std::string name;
  std::vector<std::string> open;  ///< names of the open doors; all others are shut
};

/// Something that stands on the floor and that the laser sees.
struct Furniture {
  std::string name;
  Polygon outline;
  double height = 0.8;  ///< [m]
};

/// A place that people have a name for.
struct PlanPlace {
  std::string name;
  Point2 at;        ///< a point on free floor
  Polygon outline;  ///< its area; empty if not given
};

/// A part of the floor with what it is: the truth for those who recognise kinds of places.
struct Area {
  std::string kind;  ///< one of areaKinds()
  Polygon outline;
};

/// "bifurcation", "corner", "corridor", "dead-end", "hall".
const std::vector<std::string>& areaKinds();

struct FloorPlan {
  std::string name;
  std::string source;  ///< file, for messages
  std::string description;
  Point2 origin;               ///< lower left corner of the drawing [m]
  Point2 size{10.0, 10.0};     ///< extent of the drawing [m]
  std::vector<Point2> inside;  ///< points of the interior besides the places
  std::vector<PlanWall> walls;
  std::vector<PlanDoor> doors;
  std::vector<DoorConfiguration> configurations;
  std::vector<Furniture> furniture;
  std::vector<PlanPlace> places;
  std::vector<Area> areas;
  std::string floor_kind;  ///< of the floor that no area covers; empty: not given

  /// What the floor is there: the kind of the first area that holds the point, else `floor_kind`.
  const std::string& kindAt(Point2 p) const;

  /// The place of that name. @throws hyselam::InputError with the nearest known name.
  const PlanPlace& place(const std::string& place_name) const;

  /// Puts all doors as a configuration says; their schedules end. @throws hyselam::InputError with
  /// the nearest known name.
  void setDoors(const std::string& configuration);

  /// The next time after `time` at which a door moves; infinity if none does.
  double nextDoorChange(double time) const;
};

/// Reads a plan; README.md describes the format. @throws hyselam::InputError naming file, line, key
/// and reason for anything that is not a usable plan.
FloorPlan loadFloorPlan(const std::string& path);

/// The same from text; `source` stands for the file in messages.
FloorPlan parseFloorPlan(const std::string& text, const std::string& source);

}  // namespace hyselam_sim

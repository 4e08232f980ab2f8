#include "hyselam_topological_map/ros/map_markers.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_common/ros/markers.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/place_labels.hpp"
#include "hyselam_topological_map/place_paths.hpp"

namespace hyselam_topo {
namespace {

using hyselam::color;
using hyselam::Point2;
using visualization_msgs::Marker;

// Heights of the layers [m]: just above a map at 0, in the order in which they cover each other.
constexpr double kPlaceHeight = 0.02;
constexpr double kWallHeight = 0.05;
constexpr double kGraphHeight = 0.08;
constexpr double kDoorHeight = 0.1;
constexpr double kNameHeight = 0.3;

/// A light colour for each id; ids that follow each other differ most (golden section of the hues).
/// Corridors are pale.
std_msgs::ColorRGBA placeColour(const Place* place, Id id, double alpha) {
  const double hue = 6.0 * std::fmod(0.618033988749895 * id, 1.0);
  const bool corridor = place != nullptr && place->kind == PlaceKind::kCorridor;
  const double saturation = corridor ? 0.15 : id % 2 == 0 ? 0.5 : 0.7;
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return 0.97 * (1.0 - saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  };
  return color(channel(5.0), channel(3.0), channel(1.0), alpha);
}

geometry_msgs::Point at(Point2 p, double z) {
  return hyselam::at(p.x, p.y, z);
}

class Markers {
 public:
  explicit Markers(const std::string& frame) : frame_(frame) {
    Marker all = make("", 0, Marker::CUBE);
    all.action = Marker::DELETEALL;
    array_.markers.push_back(all);
  }

  Marker make(const std::string& ns, int id, int type) const {
    return hyselam::marker(frame_, ns, id, type);
  }

  /// A list of lines of one width.
  Marker makeLines(const std::string& ns, int id, double width,
                   const std_msgs::ColorRGBA& c) const {
    Marker lines = make(ns, id, Marker::LINE_LIST);
    lines.scale.x = width;
    lines.color = c;
    return lines;
  }

  /// Unless it is a list of nothing, of which rviz would warn.
  void put(Marker marker) {
    const bool empty = marker.points.empty() && marker.type != Marker::TEXT_VIEW_FACING;
    if (!empty) array_.markers.push_back(std::move(marker));
  }

  visualization_msgs::MarkerArray take() { return std::move(array_); }

 private:
  std::string frame_;
  visualization_msgs::MarkerArray array_;
};

void line(Marker* lines, Point2 a, Point2 b, double z) {
  lines->points.push_back(at(a, z));
  lines->points.push_back(at(b, z));
}

/// Cells of one place in a row, [begin, end), over rows [low, high).
struct Block {
  Id place;
  int begin, end, low, high;
};

/// The cells of all places as rectangles: runs along the rows, joined with equal runs below.
std::vector<Block> blocksOf(const PlaceGrid& grid) {
  std::vector<Block> blocks;
  std::map<std::pair<int, int>, std::size_t> open;  // runs of the row below -> block
  for (int y = 0; y < grid.geometry.height; ++y) {
    std::map<std::pair<int, int>, std::size_t> row;
    for (int x = 0; x < grid.geometry.width;) {
      const Id id = grid.placeOf({x, y});
      int end = x + 1;
      while (end < grid.geometry.width && grid.placeOf({end, y}) == id) ++end;
      if (id != 0) {
        const auto below = open.find({x, end});
        if (below != open.end() && blocks[below->second].place == id) {
          blocks[below->second].high = y + 1;
          row[{x, end}] = below->second;
        } else {
          row[{x, end}] = blocks.size();
          blocks.push_back({id, x, end, y, y + 1});
        }
      }
      x = end;
    }
    open = std::move(row);
  }
  return blocks;
}

void addPlaces(const AugmentedTopologicalMap& map, double alpha, Markers* markers) {
  if (!map.grid) return;
  const hyselam::GridGeometry& g = map.grid->geometry;
  std::map<Id, std::vector<geometry_msgs::Point>> triangles;
  for (const Block& block : blocksOf(*map.grid)) {
    const auto corner = [&](int x, int y) {
      return at(g.origin * Point2{x * g.resolution, y * g.resolution}, kPlaceHeight);
    };
    const auto a = corner(block.begin, block.low), b = corner(block.end, block.low);
    const auto c = corner(block.end, block.high), d = corner(block.begin, block.high);
    auto& list = triangles[block.place];
    for (const auto& p : {a, b, c, a, c, d}) list.push_back(p);
  }
  for (auto& [id, points] : triangles) {
    Marker marker = markers->make("places", static_cast<int>(id), Marker::TRIANGLE_LIST);
    marker.color = placeColour(map.findPlace(id), id, alpha);
    marker.points = std::move(points);
    markers->put(std::move(marker));
  }
}

void addNames(const AugmentedTopologicalMap& map, const std::map<Id, CellBox>& boxes,
              Markers* markers) {
  for (const Place& place : map.places) {
    if (!place.centre) continue;
    Marker marker = markers->make("names", static_cast<int>(place.id), Marker::TEXT_VIEW_FACING);
    const auto box = boxes.find(place.id);
    const PlaceLabel label =
        placeLabel(map, place, box == boxes.end() ? nullptr : &box->second, "", nameOf(place));
    marker.scale.z = label.height;
    marker.pose.position = at(label.position, kNameHeight);
    marker.color = color(0.05, 0.05, 0.15);
    marker.text = label.text;
    markers->put(std::move(marker));
  }
}

void addWalls(const AugmentedTopologicalMap& map, Markers* markers) {
  // Virtual walls first: a solid wall that lies on one covers it.
  struct Style {
    WallKind kind;
    double width;
    std_msgs::ColorRGBA colour;
  };
  const Style styles[] = {{WallKind::kVirtual, 0.04, color(0.5, 0.5, 0.55, 0.9)},
                          {WallKind::kGlass, 0.08, color(0.3, 0.65, 0.95)},
                          {WallKind::kSolid, 0.14, color(0.12, 0.12, 0.16)}};
  for (const Style& style : styles) {
    Marker lines =
        markers->makeLines("walls", static_cast<int>(style.kind), style.width, style.colour);
    for (const Place& place : map.places) {
      for (const Wall& wall : place.walls) {
        if (wall.kind != style.kind) continue;
        const std::vector<Point2> points = polyline(wall);
        for (std::size_t i = 1; i < points.size(); ++i) {
          line(&lines, points[i - 1], points[i], kWallHeight);
        }
      }
    }
    markers->put(std::move(lines));
  }
}

/// The leaf, opened by a right angle about its first post, and the quarter circle it sweeps.
void drawSwing(const Door& door, Marker* lines) {
  const Segment posts = ends(door);
  const Point2 hinge = posts.first, latch = posts.second;
  const Point2 along{latch.x - hinge.x, latch.y - hinge.y};
  const Point2 across{door.normal.x * door.width, door.normal.y * door.width};
  const auto at_angle = [&](double angle) {
    return Point2{hinge.x + std::cos(angle) * along.x + std::sin(angle) * across.x,
                  hinge.y + std::cos(angle) * along.y + std::sin(angle) * across.y};
  };
  line(lines, hinge, at_angle(hyselam::kPi / 2), kDoorHeight);
  constexpr int kPieces = 8;
  for (int i = 0; i < kPieces; ++i) {
    line(lines, at_angle(hyselam::kPi / 2 * i / kPieces),
         at_angle(hyselam::kPi / 2 * (i + 1) / kPieces), kDoorHeight);
  }
}

void drawDashed(Point2 a, Point2 b, double dash, Marker* lines) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  const int dashes = std::clamp(static_cast<int>(length / (2.0 * dash)), 1, 200);
  for (int i = 0; i < dashes; ++i) {
    const auto point = [&](double share) {
      return Point2{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
    };
    line(lines, point((i + 0.25) / dashes), point((i + 0.75) / dashes), kDoorHeight);
  }
}

void addDoors(const AugmentedTopologicalMap& map, Markers* markers) {
  enum { kSwings, kThresholds, kClosed, kVirtual };
  Marker swings = markers->makeLines("doors", kSwings, 0.06, color(0.55, 0.27, 0.07));
  Marker thresholds = markers->makeLines("doors", kThresholds, 0.16, color(0.95, 0.6, 0.2));
  Marker closed = markers->makeLines("doors", kClosed, 0.16, color(0.8, 0.1, 0.1));
  Marker dashed = markers->makeLines("doors", kVirtual, 0.08, color(0.35, 0.35, 0.45));
  for (const Edge& edge : map.edges) {
    for (const Door& door : edge.doors) {
      const auto [a, b] = ends(door);
      if (!door.real) {
        drawDashed(a, b, 0.15, &dashed);
      } else if (door.state == DoorState::kClosed) {
        line(&closed, a, b, kDoorHeight);
      } else {
        line(&thresholds, a, b, kGraphHeight);
        drawSwing(door, &swings);
      }
    }
  }
  for (Marker* m : {&swings, &thresholds, &closed, &dashed}) markers->put(std::move(*m));
}

/// From all doors of a place to its centre, around its corners if the map has a grid.
void addWays(const AugmentedTopologicalMap& map, const std::map<Id, CellBox>& boxes,
             const Place& place, Marker* lines) {
  const Point2 centre{place.centre->x, place.centre->y};
  std::vector<Point2> doors;
  for (const Edge& edge : map.edges) {
    if (edge.a != place.id && edge.b != place.id) continue;
    for (const Door& door : edge.doors) doors.push_back({door.position.x, door.position.y});
    const Place* other = map.findPlace(edge.a == place.id ? edge.b : edge.a);
    if (edge.doors.empty() && edge.a == place.id && other != nullptr && other->centre) {
      line(lines, centre, {other->centre->x, other->centre->y}, kGraphHeight);
    }
  }
  std::vector<std::vector<Point2>> ways(doors.size());
  const auto box = boxes.find(place.id);
  if (box != boxes.end()) ways = waysWithin(*map.grid, place.id, box->second, doors, centre);
  for (std::size_t k = 0; k < doors.size(); ++k) {
    Point2 from = doors[k];
    for (const Point2& corner : ways[k]) {
      line(lines, from, corner, kGraphHeight);
      from = corner;
    }
    line(lines, from, centre, kGraphHeight);
  }
}

void addGraph(const AugmentedTopologicalMap& map, const std::map<Id, CellBox>& boxes,
              Markers* markers) {
  Marker spheres = markers->make("graph", 0, Marker::SPHERE_LIST);
  spheres.scale.x = spheres.scale.y = spheres.scale.z = 0.25;
  spheres.color = color(0.1, 0.25, 0.6);
  Marker lines = markers->makeLines("graph", 1, 0.05, color(0.1, 0.25, 0.6, 0.8));
  for (const Place& place : map.places) {
    if (place.centre) {
      spheres.points.push_back(at({place.centre->x, place.centre->y}, kGraphHeight));
    }
  }
  for (const Place& place : map.places) {
    if (place.centre) addWays(map, boxes, place, &lines);
  }
  markers->put(std::move(spheres));
  markers->put(std::move(lines));
}

}  // namespace

void MapMarkerParams::describe(hyselam::ParameterVisitor& visit) {
  visit("places", places, "the cells of each place in a color of its own");
  visit("names", names, "names of places");
  visit("walls", walls, "walls by their kind");
  visit("doors", doors, "doors by their state");
  visit("graph", graph, "from the center of a place through its doors to the next");
  visit("alpha", alpha, hyselam::Range::between(0.0, 1.0), "", "opacity of the places");
}

void MapMarkerParams::validate() const {
  hyselam::checkParameters(*this);
}

visualization_msgs::MarkerArray mapMarkers(const AugmentedTopologicalMap& map,
                                           const MapMarkerParams& params) {
  Markers markers(map.frame_id);
  const auto boxes = map.grid ? placeBoxes(*map.grid) : std::map<Id, CellBox>{};
  if (params.places) addPlaces(map, params.alpha, &markers);
  if (params.walls) addWalls(map, &markers);
  if (params.graph) addGraph(map, boxes, &markers);
  if (params.doors) addDoors(map, &markers);
  if (params.names) addNames(map, boxes, &markers);
  return markers.take();
}

}  // namespace hyselam_topo

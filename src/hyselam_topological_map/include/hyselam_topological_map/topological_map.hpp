// The augmented topological map of HySeLAM (Hybrid Semantic Localization and Mapping, dos Santos
// 2014, section 3.2.1): places with their walls and visual signatures, connected by doors, and the
// relation of the places to the cells of a grid map.
//
// Plain values: copy, compare and change them freely. Lengths [m], angles [rad], times [s], all
// positions in the frame `frame_id` of the map, z up from the floor (REP-103).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/point3.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/xml_extras.hpp"

namespace hyselam_topo {

/// Identifier of a place, wall or door: unique among its kind in a map, never 0, never reused for
/// another one during the map's lifetime.
using Id = std::uint32_t;

using hyselam::Covariance2;
using hyselam::Covariance3;
using hyselam::Point3;
/// Unknown XML content, preserved on round trip.
using Extras = hyselam::XmlExtras;

/// A word or name that people use for a place or a connection.
struct PlaceTerm {
  std::string text;        ///< UTF-8, not empty
  bool confirmed = false;  ///< said or confirmed by a person; otherwise it is a guess
};

/// An image in grey values or an image descriptor, as a matrix.
struct Appearance {
  /// What the values are: "grey" or the name of a descriptor of package selovis. "LBPbyHSV-U16N":
  /// local binary patterns by HSV color; U: uniform patterns, 16 color classes, N: without
  /// the second stage, which is local binary patterns of the image of patterns (U or S).
  std::string type;
  int rows = 0;
  int cols = 0;
  std::vector<float> values;  ///< row-major, rows * cols of them, finite
};

/// Kind of a wall, by its existence value e (Eq. 3.3).
enum class WallKind {
  kVirtual,  ///< 0: no wall, only the limit of a place
  kGlass,    ///< 0.5: a wall that range sensors pass through
  kSolid     ///< 1
};

/// A limit of a place (Eq. 3.3): vertical, straight or an arc of a circle.
struct Wall {
  Id id = 0;
  WallKind kind = WallKind::kSolid;
  /// Mass centre; of a curved wall it lies beside the wall, on the inner side of the arc.
  Point3 position;
  std::optional<Covariance3> position_covariance;  ///< nothing: not known
  /// Unit vector, at the middle of the wall, pointing into the place that the wall limits.
  Point3 normal{1.0, 0.0, 0.0};
  std::optional<Covariance3> normal_covariance;
  double length = 0.0;                         ///< along the floor, along the arc if curved
  double height = 0.0;                         ///< 0: not known
  std::optional<Covariance2> size_covariance;  ///< of (length, height)
  /// Curvature along the floor [1/m]: 0 straight, > 0 if the centre of the circle lies on the side
  /// that the normal points to. |curvature| * length <= 2 pi.
  double curvature = 0.0;
  double vertical_curvature = 0.0;  ///< [1/m], the same in a vertical section
  Extras extras;
};

enum class DoorState { kUnknown, kOpen, kClosed };

/// A doorway (Eq. 3.6): a straight opening between two places.
struct Door {
  Id id = 0;
  bool real = true;  ///< false: a virtual door, where two places merge into one another
  DoorState state = DoorState::kUnknown;
  Point3 position;  ///< middle of the opening
  std::optional<Covariance3> position_covariance;
  /// Unit vector through the door, from place `a` to `b` of its edge.
  Point3 normal{1.0, 0.0, 0.0};
  double width = 0.0;   ///< along the floor
  double height = 0.0;  ///< 0: not known
  std::optional<Appearance> appearance;
  Extras extras;
};

/// A connection of two places (Eq. 3.5). There is at most one edge between two places.
struct Edge {
  Id a = 0;  ///< id of a place; a < b
  Id b = 0;
  std::vector<PlaceTerm> words;
  std::vector<Door> doors;  ///< may be empty: people may say that places are connected, not how
  Extras extras;
};

/// What a place looks like from one pose (Eq. 3.4).
struct VisualSignature {
  Appearance appearance;
  Point3 position;  ///< of the camera
  std::optional<Covariance3> position_covariance;
  std::optional<double> heading;  ///< of the camera; nothing: not known, or all around
  double aperture_x = 0.0;        ///< opening angle, horizontal
  double aperture_y = 0.0;        ///< vertical
  double stamp = 0.0;             ///< time of the image
  Extras extras;
};

enum class PlaceKind {
  kRoom,
  kCorridor,
  kVirtual  ///< described by a person or cut out by virtual walls; not found by segmentation
};

/// A place (Eq. 3.2).
struct Place {
  Id id = 0;
  PlaceKind kind = PlaceKind::kRoom;
  std::vector<PlaceTerm> words;
  std::vector<Wall> walls;
  std::vector<VisualSignature> signatures;
  double area = 0.0;  ///< [m^2], 0: not known
  /// A point inside the place near its middle. Nothing for a place that is only described.
  std::optional<Point3> centre;
  std::vector<hyselam::Point2> outline;  ///< counter-clockwise, not closed; empty: not known
  Extras extras;
};

/// Which place each cell of a grid map belongs to. Two labels may mean one place.
struct PlaceGrid {
  hyselam::GridGeometry geometry;
  /// Row-major from the cell at the origin, as in hyselam::OccupancyGrid. 0: no place; else label k
  /// means the place with id `places[k - 1]`.
  std::vector<std::uint16_t> labels;
  std::vector<Id> places;  ///< 0 in it: that label means no place

  /// The place of a cell; 0 for none and outside the grid.
  Id placeOf(hyselam::Cell cell) const {
    if (!geometry.contains(cell)) return 0;
    const std::uint16_t label = labels[geometry.index(cell)];
    return label == 0 || label > places.size() ? 0 : places[label - 1u];
  }
};

/// The attributed graph M = (P, C) of Eq. 3.1 with its relation to a grid map.
struct AugmentedTopologicalMap {
  std::string frame_id = "map";
  double stamp = 0.0;         ///< time of the grid map that it comes from; 0: not known
  std::vector<Place> places;  ///< in the order of their ids
  std::vector<Edge> edges;    ///< in the order of (a, b)
  std::optional<PlaceGrid> grid;
  /// The ids that the next new place, wall and door get.
  Id next_place_id = 1;
  Id next_wall_id = 1;
  Id next_door_id = 1;
  Extras extras;

  /// Pointers into the vectors, nullptr if not found. Linear in the number of places or edges.
  const Place* findPlace(Id id) const;
  Place* findPlace(Id id);
  const Edge* findEdge(Id a, Id b) const;  ///< in any order
  Edge* findEdge(Id a, Id b);
};

/// Field-wise, no tolerance.
bool operator==(const PlaceTerm& a, const PlaceTerm& b);
bool operator==(const Appearance& a, const Appearance& b);
bool operator==(const Wall& a, const Wall& b);
bool operator==(const Door& a, const Door& b);
bool operator==(const Edge& a, const Edge& b);
bool operator==(const VisualSignature& a, const VisualSignature& b);
bool operator==(const Place& a, const Place& b);
bool operator==(const PlaceGrid& a, const PlaceGrid& b);
bool operator==(const AugmentedTopologicalMap& a, const AugmentedTopologicalMap& b);

/// The name of a place: its first confirmed word, else its first word, else "room 3".
std::string nameOf(const Place& place);

/// "room", "corridor", "virtual" and back; nothing for another word.
const char* toString(PlaceKind kind);
std::optional<PlaceKind> placeKindFromString(const std::string& text);
/// "unknown", "open", "closed" and back.
const char* toString(DoorState state);
std::optional<DoorState> doorStateFromString(const std::string& text);
/// Existence value e of a wall kind: 0, 0.5 or 1 (Eq. 3.3), and back.
double existence(WallKind kind);
std::optional<WallKind> wallKindFromExistence(double existence);

/// Puts places, edges and what they hold into the order of their ids and raises the next ids above
/// all ids in use. Call it after filling a map in code.
void normalize(AugmentedTopologicalMap& map);

/// @throws hyselam::InputError, with `source` and the part that is wrong ("place 3, wall 7"),
/// unless: ids are set, unique and below the next ids; edges join two different places of the
/// map, a < b, once each; all numbers are finite, normals of length 1, covariances symmetric with a
/// diagonal >= 0, lengths, areas and apertures >= 0; words are not empty; appearances and the grid
/// have as many values as their sizes say; labels of the grid mean places of the map.
void checkMap(const AugmentedTopologicalMap& map, const std::string& source);

}  // namespace hyselam_topo

// TopoMerg's problem (dos Santos, section 5.3): which places of the robot's map M are meant by the
// names of a person's description G? Here: both graphs as compact numbers. How well an assignment
// fits is in fitness.hpp.
//
// Plain values. Lengths [m], angles [rad], positions in the frame of the map.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_language/building/described_building.hpp"
#include "hyselam_topo/topomerg/topomerg_place_set.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// What is certain before the search: the "constraint" of section 5.3 and more of its kind.
struct MatchConstraints {
  std::vector<std::pair<Id, Id>> confirmed;  ///< (place of the map, place of the description)
  std::vector<std::pair<Id, Id>> excluded;   ///< likewise: this place does not have that name
  std::vector<Id> unnamed;                   ///< places of the map that nobody has described
};

/// Where the robot was when the person spoke. If its place is known and the description has the
/// robot's place, the two are confirmed to be the same.
struct MatchObserver {
  std::optional<Id> place;  ///< of the map
  /// Of all that has no view of its own (DescribedConnection::seen_from). Nothing: that of the last
  /// connection told with a view, and without any the heading that fits best is taken for each
  /// assignment.
  std::optional<double> heading;
  /// Where the robot stood, likewise. "The second door on the left" is counted from there on;
  /// nothing: from the end of the place that lies behind the robot.
  std::optional<hyselam::Point2> position = std::nullopt;
};

/// Both graphs by number: name i is places[i] of the description, vertex v is places[v] of the map.
struct MatchProblem {
  struct DescribedSide {
    int from = 0;  ///< number of the name that the side is seen from
    int to = 0;    ///< and of the one that lies there
    /// Left > 0, seen by the robot with MatchProblem::heading: where it looked otherwise when the
    /// side was told, by that more; spread in the order described.
    double angle = 0.0;
    double side_angle = 0.0;  ///< of the side, not spread
    double turn = 0.0;      ///< from the direction through the doors to that of the described order
    int before = 0;         ///< as many others were described before it on that side, ...
    int after = 0;          ///< and as many after it; both without those whose number was told
    double strength = 1.0;  ///< share of the weights of a side and of a place in a row, 0 .. 1
  };
  /// "The second door on the left", "ten metres ahead": where along `from` the door to `to` is.
  struct DescribedNumber {
    int from = 0;  ///< numbers of the names
    int to = 0;
    int rank = 0;           ///< from 1, or from -1 at the far end; 0: not told
    double distance = 0.0;  ///< from where the robot stood, if rank is 0 [m]; 0: the nearest
    /// From the direction through the door to that in which it is counted; nothing for a distance
    /// without a side.
    std::optional<double> turn;
    double side_angle = 0.0;                  ///< as in DescribedSide
    std::optional<hyselam::Point2> position;  ///< where the robot stood then
  };
  /// "A, then B" on one side of a place.
  struct DescribedOrder {
    int from = 0;  ///< numbers of the names: of the place that both are seen from, ...
    int first = 0;
    int then = 0;
    double turn = 0.0;      ///< from the direction through their doors to that from first to then
    double strength = 1.0;  ///< share of an order's weight, 0 .. 1
  };
  /// A way out of a vertex, or a wall where a closed door may be one.
  struct Passage {
    std::size_t to = 0;    ///< the vertex behind it
    double bearing = 0.0;  ///< through it, and the same as a vector
    double dx = 1.0, dy = 0.0;
    double x = 0.0, y = 0.0;
  };
  struct Relation {
    RelationKind kind = RelationKind::kNextTo;
    int a = 0;
    int b = 0;
    int c = -1;
    bool denied = false;
    double side_angle = 0.0;                  ///< only for kAtSide, as in DescribedSide
    std::optional<hyselam::Point2> position;  ///< only for kAfter and kBehind: where it stood then
    std::optional<double> looked = std::nullopt;  ///< only for kAfter: where it looked then
  };
  struct NameAttributes {
    double area = 0.0;  ///< [m^2], 0: not described
    int parts = 0;      ///< 0: not described
    std::optional<PlaceKind> kind;
    std::optional<SizeWord> size_word;
    int doors = 0;           ///< 0: not described
    bool elsewhere = false;  ///< on another floor: it has no place of this map
    /// It certainly has a place: answers without one lose everything. For questions of the kind
    /// "what if"; compileMatch() sets it for none.
    bool needs_place = false;
  };

  std::vector<Id> names;                   ///< ids in the description
  std::vector<Id> vertices;                ///< ids in the map
  std::vector<NameAttributes> attributes;  ///< of each name
  std::vector<char> described_edges;       ///< names x names: described as connected
  std::vector<DescribedSide> sides;
  std::vector<DescribedOrder> orders;
  std::vector<DescribedNumber> numbers;
  std::vector<Relation> relations;

  std::vector<double> area;         ///< of each vertex; 0: not known
  std::vector<double> x, y;         ///< its centre
  std::vector<double> weight;       ///< of its centre in a common centre; 0: it has no position
  std::vector<PlaceKind> kind;      ///< of each vertex
  std::vector<PlaceSet> neighbors;  ///< of each vertex in the map
  /// Of each vertex: through each door; through edges without doors on the line of the centres.
  std::vector<std::vector<Passage>> passages;
  bool has_doors = false;  ///< any edge has a door
  /// Of each vertex: walls between it and others that it has no edge to; empty: none are known.
  std::vector<std::vector<Passage>> walls;
  std::vector<PlaceSet> across_walls;  ///< of each vertex: the others behind these walls
  /// Of each vertex: stretches of its walls with nothing of the map behind them, where doors to
  /// rooms may be that the robot has not seen (`to` has no meaning); empty: none are known.
  std::vector<std::vector<Passage>> gaps;
  double typical_area = 0.0;     ///< median of the rooms of the map [m^2]; 0: not known
  std::vector<double> evidence;  ///< names x vertices, empty: none

  std::vector<int> confirmed_name;  ///< of each vertex, -1: not known
  std::vector<PlaceSet> allowed;    ///< vertices that may have name i
  std::optional<double> heading;    ///< of the robot

  std::size_t nameCount() const { return names.size(); }
  std::size_t vertexCount() const { return vertices.size(); }
  bool areConnected(std::size_t i, std::size_t j) const {
    return described_edges[i * names.size() + j] != 0;
  }
};

/// Both graphs, constraints and observer in numbers. Sides become angles (section 5.3.2 with
/// ERRATA): front 0, left pi/2, back pi, right -pi/2; n places on one side of a place are pi/(2n)
/// apart around it, the first one nearest to the back (on the front and back: the left one first).
/// With doors (SideRule) they are not spread, but come one after the other.
/// Names of another floor (DescribedPlace::floor) get no place of the map, unless one is confirmed,
/// and nothing counts that was told of them and others. Denied sides count only if the heading is
/// known, distances only if the position is.
/// A place without area counts with that of its outline. Where walls of two places without an edge
/// lie back to back for at least the width of a door, a closed door may be in them.
///
/// Throws hyselam::InputError for a description or map that is none, with more than
/// PlaceSet::kCapacity places, for constraints and evidence about places that do not exist, that
/// contradict each other, or with values outside 0 .. 1.
MatchProblem compileMatch(const DescribedBuilding& building, const AugmentedTopologicalMap& map,
                          const MatchObserver& observer = {},
                          const MatchConstraints& constraints = {},
                          const std::vector<MatchEvidence>& evidence = {});

}  // namespace hyselam_topo

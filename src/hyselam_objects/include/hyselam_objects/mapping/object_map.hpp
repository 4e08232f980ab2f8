// The object map M_S = (O, R) of HySeLAM (dos Santos, Eq. 3.7 and 3.8): which objects there are,
// where they are, and their relations to each other and to places.
//
// Plain values. Lengths [m], angles [rad], times [s]; positions in the frame `frame_id`, z up from
// the floor (REP-103).
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_objects/mapping/outline.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_objects {

using hyselam::Covariance3;
using hyselam::Point3;
using hyselam_topo::Id;

/// W_R of Eq. 3.8: "a is ... b". An object is `at` a place; that it is near, before, behind or
/// beside a place says nothing of the place that it is at.
enum class RelationWord {
  kAt,
  kInside,
  kIn,
  kOn,     ///< b carries a
  kOver,   ///< a is above b; people say it of something that lies on b, too
  kUnder,  ///< b is above a
  kLeft,   ///< beside b, on its left for somebody who looks at b
  kRight,
  kTop,  ///< on the top of b
  kNear,
  kBehind,
  kFront,    ///< in front of b
  kAgainst,  ///< beside b and touching it: "leans against"
  kBetween   ///< between b and what another relation of a tells
};
constexpr int kRelationWords = 14;

/// "at", "inside", "in", "on", "over", "under", "left", "right", "top", "near", "behind", "front",
/// "against", "between" and back.
const char* toString(RelationWord word);
std::optional<RelationWord> relationWordFromString(const std::string& text);

/// Whether the relation is one of support or containment: an object has only one such at a time.
bool isSupport(RelationWord word);

/// Whether an object may be related so to a place.
bool mayRelateToPlace(RelationWord word);

/// A place that objects are related to; a place of the topological map, once that is known.
struct ObjectPlace {
  Id id = 0;           ///< unique among the places of this map, never 0
  std::string name;    ///< as people call it
  Id topological = 0;  ///< id in the topological map; 0: not known
};

/// Measured position and box of an object.
struct ObjectPose {
  Point3 position;                            ///< center of the box around it
  std::array<double, 3> size{0.0, 0.0, 0.0};  ///< of that box along its axes
  double yaw = 0.0;                           ///< of its first axis
  Covariance3 covariance{};                   ///< of the position
};

/// A period in which an object stayed at one spot; used to judge how movable it is.
struct ObjectStay {
  double from = 0.0;   ///< first seen there
  double until = 0.0;  ///< last seen there
  Point3 position;
};

/// Of an object the map remembers so many stays: more would say no more of how movable it is.
constexpr std::size_t kMostStays = 200;

/// An instance of a generic object (o of Eq. 3.7 with its properties O_F).
struct ObjectInstance {
  Id id = 0;         ///< unique, never 0, never used again
  std::string kind;  ///< name of its generic object: "cup"
  /// "colour": "red", "size": "small", "owner"; "furniture": "yes" of all furniture;
  /// "structure": "yes" of parts of the building that things stand at, as a wall.
  std::map<std::string, std::string> properties;
  bool described = false;          ///< people have described it
  std::optional<ObjectPose> pose;  ///< nothing: never seen
  Outline outline;                 ///< of all views; empty: that of its box
  std::vector<float> descriptor;   ///< mean of its views; empty: never seen
  int detections = 0;              ///< number of views
  int missed_detections = 0;       ///< number of frames that show its place free
  int overlooked = 0;              ///< number of frames that show something else there
  double last_seen = 0.0;
  double existence = 0.5;  ///< probability that it is where the map says
  std::vector<ObjectStay>
      history;  ///< oldest first, the newest kMostStays; the last is the present
};

/// R_ij = {W_R, E_R, M_R} of Eq. 3.8.
struct ObjectRelation {
  Id object = 0;  ///< i
  RelationWord word = RelationWord::kAt;
  Id other = 0;                  ///< j, an object; 0 if it is a place
  Id place = 0;                  ///< j, a place; 0 if it is an object
  std::optional<Point3> vector;  ///< E_R: from the center of j to that of i
  double movability = 0.5;       ///< M_R: 0 fixed .. 1 movable
  bool described = false;        ///< people have described it; otherwise it was measured
};

struct ObjectMap {
  std::string frame_id = "map";
  double stamp = 0.0;                     ///< of the last change; 0: not known
  std::vector<ObjectPlace> places;        ///< sorted by id
  std::vector<ObjectInstance> objects;    ///< sorted by id
  std::vector<ObjectRelation> relations;  ///< sorted by (object, word, other, place)
  Id next_place_id = 1;
  Id next_object_id = 1;

  const ObjectPlace* findPlace(Id id) const;
  const ObjectInstance* find(Id id) const;
  ObjectInstance* find(Id id);
  /// The place that an object is at; 0: not known.
  Id placeOf(Id object) const;
  /// Relations of which the object is the first (i).
  std::vector<const ObjectRelation*> relationsOf(Id object) const;

  Id addPlace(const std::string& name, Id topological = 0);
  Id addObject(const std::string& kind);
  /// Inserts the relation, or replaces the one with the same object, word, other and place.
  void relate(const ObjectRelation& relation);
  /// Removes an object and all its relations.
  void remove(Id object);
};

bool operator==(const ObjectPlace& a, const ObjectPlace& b);
bool operator==(const ObjectInstance& a, const ObjectInstance& b);
bool operator==(const ObjectRelation& a, const ObjectRelation& b);
bool operator==(const ObjectMap& a, const ObjectMap& b);

/// @throws hyselam::InputError with `source` and the part that is wrong unless ids are there,
/// unique
///         and below the next ones; relations join an object with another object or with a place,
///         (see mayRelateToPlace()); numbers are finite, sizes, counts and covariances >= 0,
///         probabilities and movabilities in 0 .. 1; names are words.
void checkMap(const ObjectMap& map, const std::string& source);

/// XML; the schema is share/hyselam_objects/xsd/object_map.xsd. As for dictionaries.
std::string toXml(const ObjectMap& map, const std::string& source = "object map");
ObjectMap objectMapFromXml(const std::string& text, const std::string& source = "object map");
void saveXml(const std::string& path, const ObjectMap& map);
ObjectMap loadObjectMap(const std::string& path);

/// One line per object, sorted: "red cup at kitchen, on table, near lamp". For people and tests.
std::vector<std::string> summaryLines(const ObjectMap& map);

}  // namespace hyselam_objects

// What a person has described of a building (dos Santos, section 5.1, Fig. 5.5): places with names
// and sizes, which of them are joined, on which side they lie, and where the robot stood meanwhile.
// It is G_human of section 5.3; TopoParser makes it from text, TopoMerg matches it with the robot's
// map.
//
// Plain values. Lengths [m]. There are no positions: people describe sides, not coordinates.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// Where a place lies, seen by the robot as it stood at the moment of the description.
enum class Side { kUnknown, kFront, kLeft, kBack, kRight };

/// "unknown", "front", "left", "back", "right" and back; nothing for another word.
const char* toString(Side side);
std::optional<Side> sideOf(const std::string& text);

/// A size told by a word: "a tiny office", "the library is huge".
enum class SizeWord { kSmall, kLarge };

/// "small", "large" and back; nothing for another word.
const char* toString(SizeWord word);
std::optional<SizeWord> sizeWordOf(const std::string& text);

/// A place as people described it.
struct DescribedPlace {
  Id id = 0;                         ///< unique in the description, never 0
  std::string name;                  ///< as first mentioned, without article: "room I-109"
  std::vector<std::string> aliases;  ///< "also known as"
  /// Stated, or guessed from the words of the name ("corridor", "hall"); nothing: not known.
  std::optional<PlaceKind> kind;
  std::optional<double> length;  ///< the first and ...
  std::optional<double> width;   ///< ... the second of "6 by 8 metres"
  std::optional<double> area;    ///< described as such, or length times width
  /// "divided into six rooms": how many places of a map this one may be made of.
  std::optional<int> parts;
  std::optional<SizeWord> size_word;  ///< compared with the rooms of the building
  std::optional<int> doors;           ///< "the archive has two doors", >= 1
  /// Storeys above (> 0) or below (< 0) the one where the robot is; nothing: on its own. A place of
  /// another floor is on no map of this one.
  std::optional<int> floor;
};

/// The name and the aliases, in the order in which they were mentioned.
std::vector<std::string> allNamesOf(const DescribedPlace& place);

/// Whether two things were told as seen alike, so that their sides mean the same directions: the
/// robot looked less than 45 degrees otherwise. True if one of the views is not known.
bool lookAlike(const std::optional<hyselam::Pose2>& a, const std::optional<hyselam::Pose2>& b);
/// The same, and the robot stood at most 1.5 m away: numbers are counted from the same door, too.
bool areSameView(const std::optional<hyselam::Pose2>& a, const std::optional<hyselam::Pose2>& b);

/// The side of what lay on `side` as seen from `then`, seen from `now`: turned by quarters, as it
/// is where one of the views is not known; kUnknown where they differ by an eighth of a turn.
Side sideSeenFrom(Side side, const std::optional<hyselam::Pose2>& then,
                  const std::optional<hyselam::Pose2>& now);

/// Two joined places: "On your left you have A", said while the robot is in `from`; "in the kitchen
/// you have the laundry" joins kitchen and laundry without a side.
struct DescribedConnection {
  Id from = 0;  ///< the place that the side is seen from (the "main vertex" of section 5.3.2)
  Id to = 0;
  Side side = Side::kUnknown;
  /// Place in the row of those described of the same `from` and side, from 0: "A, then B" gives 0
  /// and 1.
  std::size_t order = 0;
  /// "The second door on the left" is 2: its number among all places at that side of `from`, the
  /// nearest to where the robot stood first; "the last" is -1, counted from the far end. Nothing:
  /// not told; `order` then tells only what comes before what.
  std::optional<int> rank = std::nullopt;
  /// "Ten metres ahead on your left": from where the robot stood, along its way [m]. 0: "here on
  /// your left", the nearest of that side, be it a little ahead or behind.
  std::optional<double> distance = std::nullopt;
  /// Where the robot stood and looked when side, number or distance were told, in the frame of the
  /// map; nothing: not known.
  std::optional<hyselam::Pose2> seen_from = std::nullopt;
  /// How probable it is that the side was meant so, > 0 .. 1, ...
  double side_certainty = 1.0;
  /// ... and that it comes behind the one before it in its row.
  double order_certainty = 1.0;
};

/// What people say of places besides connections.
enum class RelationKind {
  kNextTo,    ///< a and b lie side by side
  kOpposite,  ///< a and b face each other
  kBetween,   ///< a lies between b and c
  kAtEndOf,   ///< a lies at an end of b
  kInside,    ///< a is a part of b
  kAfter,     ///< a comes right after b on the way from c, where the robot stood (0: not told)
  kBehind,    ///< a lies behind b, seen from where the robot stood
  kLarger,    ///< a is larger than b
  kJoined,    ///< a door or way joins a and b; only denied, others are connections
  kAtSide     ///< a lies at `side` of b as the robot saw it; only denied, as above
};

const char* toString(RelationKind kind);
std::optional<RelationKind> relationKindOf(const std::string& text);

struct DescribedRelation {
  RelationKind kind = RelationKind::kNextTo;
  Id a = 0;
  Id b = 0;
  Id c = 0;                    ///< only for kBetween and kAfter, otherwise 0
  Side side = Side::kUnknown;  ///< only for kAtSide
  bool denied = false;         ///< "the lab is not next to the office"
  /// As DescribedConnection::seen_from; only for kAfter, kBehind and kAtSide.
  std::optional<hyselam::Pose2> seen_from = std::nullopt;
};

/// The whole description.
struct DescribedBuilding {
  std::vector<DescribedPlace> places;            ///< in the order of their ids
  std::vector<DescribedConnection> connections;  ///< at most one between two places, as described
  std::vector<DescribedRelation> relations;
  std::optional<Id> robot_place;  ///< where people last said that the robot is
  /// "This house is divided into six rooms": of how many places, corridors among them, it is made.
  std::optional<int> place_count;

  const DescribedPlace* findPlace(Id id) const;
  DescribedPlace* findPlace(Id id);
};

bool operator==(const DescribedPlace& a, const DescribedPlace& b);
bool operator==(const DescribedConnection& a, const DescribedConnection& b);
bool operator==(const DescribedRelation& a, const DescribedRelation& b);
bool operator==(const DescribedBuilding& a, const DescribedBuilding& b);

/// Throws hyselam::InputError with `source` and the part that is wrong, unless: ids are there and
/// unique, names and aliases are not empty, UTF-8 and without control characters, sizes finite and
/// > 0, parts >= 1, connections and relations join different places of the description, two places
/// are connected at most once, certainties are > 0 and at most 1.
void checkDescription(const DescribedBuilding& building, const std::string& source);

/// How sure it is, from something else than words (objects, pictures), that a place has a name.
struct MatchEvidence {
  Id place = 0;        ///< of the map
  Id name = 0;         ///< of the description
  double value = 0.0;  ///< 0 .. 1
};

}  // namespace hyselam_topo

#include "hyselam_language/building/described_building.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace {

constexpr std::array<const char*, 5> kSides{"unknown", "front", "left", "back", "right"};
constexpr std::array<const char*, 10> kRelations{"next_to", "opposite", "between", "at_end_of",
                                                 "inside",  "after",    "behind",  "larger",
                                                 "joined",  "at_side"};
constexpr std::array<const char*, 2> kSizeWords{"small", "large"};

/// People count doors, and storeys, no further.
constexpr int kMaxRank = 1000;
constexpr double kMaxDistance = 10000.0;  // [m]
/// What is on the left there is not on the left here.
constexpr double kOtherView = 0.25 * hyselam::kPi;
constexpr double kOtherStand = 1.5;  // [m]

/// More than anybody tells of one side; a file can carry it as a whole number.
constexpr std::size_t kMaxOrder = 1000000;

using hyselam::Pose2;

bool areEqual(const std::optional<Pose2>& a, const std::optional<Pose2>& b) {
  if (!a || !b) return !a && !b;
  return a->x == b->x && a->y == b->y && a->theta == b->theta;
}

template <typename Enum, std::size_t N>
std::optional<Enum> numberOf(const std::array<const char*, N>& names, const std::string& text) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) return std::nullopt;
  return static_cast<Enum>(found - names.begin());
}

}  // namespace

std::vector<std::string> allNamesOf(const DescribedPlace& place) {
  std::vector<std::string> names{place.name};
  names.insert(names.end(), place.aliases.begin(), place.aliases.end());
  return names;
}

const char* toString(Side side) {
  return kSides.at(static_cast<std::size_t>(side));
}
std::optional<Side> sideOf(const std::string& text) {
  return numberOf<Side>(kSides, text);
}
const char* toString(RelationKind kind) {
  return kRelations.at(static_cast<std::size_t>(kind));
}
std::optional<RelationKind> relationKindOf(const std::string& text) {
  return numberOf<RelationKind>(kRelations, text);
}

const char* toString(SizeWord word) {
  return kSizeWords.at(static_cast<std::size_t>(word));
}
std::optional<SizeWord> sizeWordOf(const std::string& text) {
  return numberOf<SizeWord>(kSizeWords, text);
}

DescribedPlace* DescribedBuilding::findPlace(Id id) {
  const auto found = std::find_if(places.begin(), places.end(),
                                  [id](const DescribedPlace& place) { return place.id == id; });
  return found == places.end() ? nullptr : &*found;
}

const DescribedPlace* DescribedBuilding::findPlace(Id id) const {
  return const_cast<DescribedBuilding*>(this)->findPlace(id);
}

bool lookAlike(const std::optional<Pose2>& a, const std::optional<Pose2>& b) {
  return !a || !b || std::abs(hyselam::normalizeAngle(a->theta - b->theta)) < kOtherView;
}

bool areSameView(const std::optional<Pose2>& a, const std::optional<Pose2>& b) {
  return lookAlike(a, b) && (!a || !b || hyselam::distance(*a, *b) < kOtherStand);
}

Side sideSeenFrom(Side side, const std::optional<Pose2>& then, const std::optional<Pose2>& now) {
  if (side == Side::kUnknown || !then || !now) return side;
  constexpr double kQuarter = 0.5 * hyselam::kPi;
  constexpr double kClear = 0.3;  // of a quarter, off the next one
  const double quarters = hyselam::normalizeAngle(then->theta - now->theta) / kQuarter;
  const int turned = static_cast<int>(std::lround(quarters));
  if (std::abs(quarters - turned) > kClear) return Side::kUnknown;
  constexpr std::array<Side, 4> kRound{Side::kFront, Side::kLeft, Side::kBack, Side::kRight};
  const auto at = std::find(kRound.begin(), kRound.end(), side) - kRound.begin();
  return kRound.at(static_cast<std::size_t>((at + turned + 4) % 4));
}

bool operator==(const DescribedPlace& a, const DescribedPlace& b) {
  const auto all = [](const DescribedPlace& p) {
    return std::tie(p.id, p.name, p.aliases, p.kind, p.length, p.width, p.area, p.parts,
                    p.size_word, p.doors, p.floor);
  };
  return all(a) == all(b);
}

bool operator==(const DescribedConnection& a, const DescribedConnection& b) {
  const auto all = [](const DescribedConnection& c) {
    return std::tie(c.from, c.to, c.side, c.order, c.rank, c.distance, c.side_certainty,
                    c.order_certainty);
  };
  return all(a) == all(b) && areEqual(a.seen_from, b.seen_from);
}

bool operator==(const DescribedRelation& a, const DescribedRelation& b) {
  const auto all = [](const DescribedRelation& r) {
    return std::tie(r.kind, r.a, r.b, r.c, r.side, r.denied);
  };
  return all(a) == all(b) && areEqual(a.seen_from, b.seen_from);
}

bool operator==(const DescribedBuilding& a, const DescribedBuilding& b) {
  return std::tie(a.places, a.connections, a.relations, a.robot_place, a.place_count) ==
         std::tie(b.places, b.connections, b.relations, b.robot_place, b.place_count);
}

void checkDescription(const DescribedBuilding& building, const std::string& source) {
  const auto require = [&source](bool holds, const std::string& what) {
    if (!holds) throw hyselam::InputError(source, "", what);
  };
  std::set<Id> ids;
  for (const DescribedPlace& place : building.places) {
    const std::string who = "place " + std::to_string(place.id);
    require(place.id != 0, "a place has the id 0");
    require(ids.insert(place.id).second, who + " stands there twice");
    require(!place.name.empty(), who + " has no name");
    const std::string wrong = hyselam::wordError(place.name);
    require(wrong.empty(), (who + ": the name ").append(wrong));
    for (const std::string& alias : place.aliases) {
      require(!alias.empty(), who + " has an empty alias");
      const std::string wrong_alias = hyselam::wordError(alias);
      require(wrong_alias.empty(), (who + ": an alias ").append(wrong_alias));
    }
    for (const auto& size : {place.length, place.width, place.area}) {
      require(!size || (std::isfinite(*size) && *size > 0.0), who + " has a size that is not > 0");
    }
    require(!place.parts || *place.parts >= 1, who + " has fewer than one part");
    require(!place.doors || *place.doors >= 1, who + " has fewer than one door");
    require(!place.floor || std::abs(*place.floor) <= kMaxRank, who + " is on no floor");
  }
  const auto known = [&](Id id, const std::string& where) {
    require(ids.count(id) != 0,
            where + " names place " + std::to_string(id) + ", which is missing");
  };
  std::set<std::pair<Id, Id>> joined;
  for (const DescribedConnection& connection : building.connections) {
    known(connection.from, "a connection");
    known(connection.to, "a connection");
    require(connection.from != connection.to, "a connection joins a place with itself");
    require(connection.order < kMaxOrder,
            "a connection is beyond the " + std::to_string(kMaxOrder) + "th of its side");
    const auto& rank = connection.rank;
    require(!rank || (*rank != 0 && std::abs(*rank) <= kMaxRank), "a connection has no such rank");
    const auto& distance = connection.distance;
    require(!distance || (*distance >= 0.0 && *distance <= kMaxDistance),
            "a connection is at no such distance");
    for (const double certainty : {connection.side_certainty, connection.order_certainty})
      require(certainty > 0.0 && certainty <= 1.0, "a connection has no such certainty");
    require(!connection.seen_from || connection.seen_from->isFinite(),
            "a connection was seen from nowhere");
    require(joined.insert(std::minmax(connection.from, connection.to)).second,
            "places " + std::to_string(connection.from) + " and " + std::to_string(connection.to) +
                " are connected twice");
  }
  for (const DescribedRelation& relation : building.relations) {
    known(relation.a, "a relation");
    known(relation.b, "a relation");
    const bool between = relation.kind == RelationKind::kBetween;
    const bool after = relation.kind == RelationKind::kAfter;
    if (between || (after && relation.c != 0)) known(relation.c, "a relation");
    require(between || after || relation.c == 0, "a relation of two places names a third");
    const bool at_side = relation.kind == RelationKind::kAtSide;
    require(at_side == (relation.side != Side::kUnknown), "a relation has a side, or lacks it");
    const bool only_denied = at_side || relation.kind == RelationKind::kJoined;
    require(!only_denied || relation.denied, "such a relation is only denied");
    require(!relation.seen_from || relation.seen_from->isFinite(),
            "a relation was seen from nowhere");
    require(relation.a != relation.b && relation.a != relation.c && relation.b != relation.c,
            "a relation names a place twice");
  }
  require(!building.place_count || *building.place_count >= 1,
          "it is made of fewer than one place");
  if (building.robot_place) known(*building.robot_place, "the robot's place");
}

}  // namespace hyselam_topo

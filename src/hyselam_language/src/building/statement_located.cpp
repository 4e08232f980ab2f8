// "The lab is the second door on the left, next to the stairs": where a place lies in several ways
// at once.
#include <algorithm>
#include <cmath>

#include "edit_description.hpp"
#include "hyselam_common/numbers.hpp"
#include "record_facts.hpp"
#include "said_places.hpp"
#include "statement_kinds.hpp"

namespace hyselam_topo {
namespace statements {
namespace {

constexpr double kStep = 0.75;            // [m], of a person
constexpr double kMaxDistance = 10000.0;  // [m]
constexpr double kMaxFloor = 1000.0;

/// What is said of where all the places of the statement lie.
struct Location {
  bool in_row = false;  ///< side, number or "in the corridor": a place of a row
  Placement row;        ///< without `to`
  std::vector<DescribedRelation> relations;  ///< without `a`, or without `b` if `swapped`
  std::vector<Id> joined;
  std::optional<int> floor;
  std::size_t count() const {
    return (in_row ? 1u : 0u) + relations.size() + joined.size() + (floor ? 1u : 0u);
  }
};

constexpr Id kItself = 0;  ///< in relations: the place that is located

std::optional<double> distanceOf(Statement& s) {
  auto distance = s.said().number("distance");
  if (!distance && s.said().number("steps")) distance = kStep * *s.said().number("steps");
  if (distance && !(*distance >= 0.0 && *distance <= kMaxDistance)) {
    s.fail(IssueKind::kMeaningless, "out_of_range", {{"value", shown(*distance)}});
  }
  return distance;
}

/// "The first door on the right is the bar, the second is the lab": the side of the place that the
/// last statement gave another number.
Side sideOfRow(Statement& s, Id from, int rank) {
  if (s.context().subjects.size() != 1) return Side::kUnknown;
  const DescribedConnection* last = findConnection(s.building(), from, s.context().subjects[0]);
  const bool in_row = last != nullptr && last->from == from && last->rank && *last->rank != rank &&
                      areSameView(last->seen_from, s.listener().viewpoint);
  return in_row ? last->side : Side::kUnknown;
}

/// "Then comes the lab": on the side of the place behind which it comes, if that is in a row of
/// where the robot is, seen as now; nothing otherwise.
void continueRow(Statement& s, Location* location) {
  const auto after = s.said().names("after");
  const auto robot = s.building().robot_place;
  if (after.size() != 1 || after[0].reference != "it" || !robot) return;
  const Id last = placesOf(s, "after").front();
  const DescribedConnection* found = findConnection(s.building(), *robot, last);
  const bool in_row = found != nullptr && found->from == *robot && found->side != Side::kUnknown &&
                      lookAlike(found->seen_from, s.listener().viewpoint);
  if (!in_row) return;
  location->in_row = true;
  location->row.from = *robot;
  location->row.side = found->side;
  s.context().side = found->side;
}

/// Side, number and distance.
void readRow(Statement& s, Location* location) {
  const Utterance& u = s.said();
  Placement& row = location->row;
  const bool within = u.find("within") != nullptr;
  row.rank = rankOf(s);
  const bool sided = u.find("side") != nullptr;
  location->in_row = within || sided || row.rank;
  row.distance = distanceOf(s);
  if (!location->in_row) return continueRow(s, location);
  if (sided && !takeSide(s, &row.side)) location->in_row = within || row.rank;
  if (!location->in_row) return;
  takeHere(s, &row);
  // "The second door in the corridor" needs no robot there.
  if (within) row.from = placeOf(s, "within");
  const auto robot = s.building().robot_place;
  if (!within || (sided && robot && *robot != row.from)) row.from = observer(s);
  if (row.rank && !sided && !within && !s.isCorrection()) {
    row.side = sideOfRow(s, row.from, *row.rank);
  }
}

void readRelations(Statement& s, Location* location) {
  const auto add = [&](const char* slot, RelationKind kind) {
    for (const Id other : placesOf(s, slot)) {
      location->relations.push_back(relationOf(kind, kItself, other));
    }
  };
  add("next_to", RelationKind::kNextTo);
  add("opposite", RelationKind::kOpposite);
  add("end_of", RelationKind::kAtEndOf);
  add("behind", RelationKind::kBehind);
  add("after", RelationKind::kAfter);
  add("part_of", RelationKind::kInside);
  for (const Id other : placesOf(s, "before")) {
    location->relations.push_back(relationOf(RelationKind::kAfter, other, kItself));
  }
  // "In front, on the right": opposite what was spoken of last, if that lies on the other side.
  const std::vector<Id>& last = s.context().subjects;
  if (s.said().find("across") != nullptr && last.size() == 1 && location->in_row) {
    const DescribedConnection* found =
        findConnection(s.building(), location->row.from, last.front());
    const Side side = location->row.side;
    const bool other = found != nullptr && found->from == location->row.from &&
                       lookAlike(found->seen_from, s.listener().viewpoint) &&
                       ((found->side == Side::kLeft && side == Side::kRight) ||
                        (found->side == Side::kRight && side == Side::kLeft));
    if (other) {
      location->relations.push_back(relationOf(RelationKind::kOpposite, kItself, last.front()));
    }
  }
  if (s.said().find("between") != nullptr) {
    const std::vector<Id> both = placesBetween(s);
    location->relations.push_back(relationOf(RelationKind::kBetween, kItself, both[0], both[1]));
  }
  for (const char* slot : {"to", "via"}) {
    for (const Id other : placesOf(s, slot)) location->joined.push_back(other);
  }
}

/// Storeys above or below, by word or by number.
std::optional<int> floorOf(Statement& s) {
  const Utterance& u = s.said();
  std::optional<double> floor = u.number("floors_up");
  if (u.number("floors_down")) floor = -*u.number("floors_down");
  if (u.find("floor") != nullptr) floor = hyselam::parseNumber(u.word("floor"));
  if (!floor) return std::nullopt;
  if (!(std::abs(*floor) <= kMaxFloor)) {
    s.fail(IssueKind::kMeaningless, "out_of_range", {{"value", shown(*floor)}});
  }
  return static_cast<int>(*floor);
}

Location locationOf(Statement& s) {
  Location location;
  readRow(s, &location);
  readRelations(s, &location);
  location.floor = floorOf(s);
  return location;
}

/// The relation of a place; what comes after what is seen from where the robot is.
DescribedRelation placed(Statement& s, DescribedRelation relation, Id id, bool with_from) {
  (relation.a == kItself ? relation.a : relation.b) = id;
  if (relation.kind == RelationKind::kAfter && relation.c == 0) {
    const Id from = with_from ? placeOf(s, "from") : s.building().robot_place.value_or(0);
    if (from != relation.a && from != relation.b) relation.c = from;
  }
  return relation;
}

void takeFloor(Statement& s, Id id, int floor) {
  std::optional<int>& known = s.at(id).floor;
  if (s.isDenial()) {
    if (known != floor) refuseDenial(s);
    known.reset();
    return s.setCorrected();
  }
  if (known && *known != floor) s.replaces("other_floor", {{"place", s.nameOf(id)}});
  known = floor;
}

void deny(Statement& s, const Location& location, Id id) {
  const bool sized = !s.said().word("size_word").empty();
  if (location.count() + (sized ? 1u : 0u) != 1) s.fail(IssueKind::kMeaningless, "one_denial");
  if (sized) return takeSizeWord(s, id);
  if (location.floor) return takeFloor(s, id, *location.floor);
  if (!location.joined.empty()) {
    return recordDenial(s, relationOf(RelationKind::kJoined, id, location.joined.front()));
  }
  if (!location.in_row) {
    const bool with_from = s.said().find("from") != nullptr;
    return recordDenial(s, placed(s, location.relations.front(), id, with_from));
  }
  const Placement& row = location.row;
  if (!row.rank) {
    DescribedRelation denial = relationOf(RelationKind::kAtSide, id, row.from);
    denial.side = row.side;
    if (row.side == Side::kUnknown) denial.kind = RelationKind::kJoined;
    return recordDenial(s, denial);
  }
  for (DescribedConnection& each : s.building().connections) {
    const bool meant =
        each.from == row.from && each.to == id && each.rank == row.rank && each.side == row.side;
    if (!meant) continue;
    each.rank.reset();
    return s.setCorrected();
  }
  refuseDenial(s);
}

/// A place of another floor is joined with nothing here.
bool isElsewhere(Statement& s, Id id, const Location& location) {
  const std::optional<int> floor = location.floor ? location.floor : s.at(id).floor;
  return floor && *floor != 0;
}

void record(Statement& s, const Location& location, Id id) {
  if (location.floor) takeFloor(s, id, *location.floor);
  bool placed_in_row = false;
  if (location.in_row && isElsewhere(s, id, location)) {
    s.report(IssueKind::kNotice, "side_left_out");
  } else if (location.in_row) {
    Placement row = location.row;
    row.to = id;
    for (const DescribedRelation& each : location.relations) {
      if (each.kind == RelationKind::kAfter && each.a == kItself) row.behind = each.b;
    }
    recordConnection(s, row);
    placed_in_row = true;
  }
  const bool with_from = !location.in_row && s.said().find("from") != nullptr;
  for (const DescribedRelation& each : location.relations) {
    recordRelation(s, placed(s, each, id, with_from));
    if (each.kind == RelationKind::kAtEndOf && !isElsewhere(s, id, location)) {
      recordConnection(s, Placement(each.b, id));
    }
  }
  for (const Id other : location.joined) recordConnection(s, Placement(other, id));
  if (location.row.distance && !placed_in_row) {
    if (location.count() == 0) s.fail(IssueKind::kMeaningless, "distance_alone");
    s.report(IssueKind::kNotice, "distance_left_out");
  }
}

/// "Not on the left but on the right", "not next to the lab but ...": what it was said to be.
void forgetLocation(Statement& s, const Location& location, Id id) {
  s.setCorrected();
  const Utterance& u = s.said();
  const auto side = hyselam_topo::sideOf(u.word("was_side"));
  // "It is on the left and not on the left."
  if (side && location.in_row && *side == location.row.side) {
    s.fail(IssueKind::kContradiction, "both_ways");
  }
  if (side && *side != Side::kUnknown) {
    DescribedRelation denial = relationOf(RelationKind::kAtSide, id, observer(s));
    denial.side = *side;
    recordDenial(s, denial);
  }
  const auto rank = hyselam::parseNumber(u.word("was_nth"));
  for (DescribedConnection& each : s.building().connections) {
    if (rank && each.to == id && each.rank == static_cast<int>(*rank)) each.rank.reset();
  }
  // "Opposite the pool, not next to it": to what it lies opposite.
  const auto was = s.said().names("was");
  const bool same = !was.empty() && was.front().reference == "it";
  std::vector<Id> others = same ? std::vector<Id>{} : placesOf(s, "was");
  for (const DescribedRelation& each : location.relations) {
    const Id other = each.a == kItself ? each.b : each.a;
    if (std::find(others.begin(), others.end(), other) != others.end()) {
      s.fail(IssueKind::kContradiction, "both_ways");
    }
  }
  if (same) {
    for (const DescribedRelation& each : location.relations) {
      others.push_back(each.a == kItself ? each.b : each.a);
    }
  }
  auto& all = s.building().relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const DescribedRelation& each) {
                             const Id other = each.a == id ? each.b : each.b == id ? each.a : 0;
                             return !each.denied && other != 0 &&
                                    std::find(others.begin(), others.end(), other) != others.end();
                           }),
            all.end());
  for (const Id other : others) {
    const DescribedConnection* found = findConnection(s.building(), id, other);
    if (found != nullptr && found->side == Side::kUnknown) removeConnection(*found, &s.building());
  }
}

/// Where the next place of a row lies: "after the bar come the lab and the store". With `ordered`
/// ("next to the bar is the lab, then the store") it lies where the first one does in no other way
/// than side and floor, but behind the last one.
Location behindTheLast(Location location, Id last, bool ordered) {
  location.row.rank.reset();
  location.row.distance.reset();
  for (DescribedRelation& each : location.relations) {
    if (each.kind == RelationKind::kAfter && each.a == kItself) each.b = last;
  }
  if (!ordered) return location;
  auto& all = location.relations;
  Id from = 0;
  bool on = false;
  for (const DescribedRelation& each : all) {
    if (each.kind == RelationKind::kNextTo) from = each.a == kItself ? each.b : each.a;
    on = on || (each.kind == RelationKind::kAfter && each.a == kItself);
  }
  const auto isOfFirst = [](const DescribedRelation& each) {
    return each.kind == RelationKind::kNextTo || each.kind == RelationKind::kOpposite ||
           each.kind == RelationKind::kAtEndOf || each.kind == RelationKind::kBehind;
  };
  const bool any = std::any_of(all.begin(), all.end(), isOfFirst);
  all.erase(std::remove_if(all.begin(), all.end(), isOfFirst), all.end());
  if (any && !on) all.push_back(relationOf(RelationKind::kAfter, kItself, last, from));
  return location;
}

/// Whether the places were told as a row: "A, then B".
bool areOrdered(const std::vector<SaidName>& names) {
  return std::any_of(names.begin(), names.end(), [](const SaidName& each) { return each.follows; });
}

/// "The library has moved, it is now next to the bar": nothing of where it was holds.
void forgetWhereItWas(Statement& s, Id id) {
  auto& relations = s.building().relations;
  relations.erase(std::remove_if(relations.begin(), relations.end(),
                                 [id](const DescribedRelation& each) {
                                   return each.a == id || each.b == id || each.c == id;
                                 }),
                  relations.end());
  const std::vector<DescribedConnection> all = s.building().connections;
  for (const DescribedConnection& each : all) {
    if (each.from == id || each.to == id) removeConnection(each, &s.building());
  }
  s.setCorrected();
}

}  // namespace

void located(Statement& s) {
  const Utterance& u = s.said();
  const std::vector<Id> ids = countedPlaces(s);
  const Location location = locationOf(s);
  const bool sized = u.number("length") || u.number("width") || u.number("area") ||
                     u.number("doors") || !u.word("size_word").empty();
  if (location.count() == 0 && !location.row.distance && !sized) {
    s.fail(IssueKind::kMeaningless, "nothing_said");
  }
  // "The first on the left is the bar, then the lab": the others stand behind it.
  const bool ordered = areOrdered(u.names("places"));
  const int rank = location.row.rank.value_or(0);
  const bool first_of_row = (rank == 1 || (rank > 0 && ordered)) && !s.isDenial();
  if (location.row.rank && ids.size() != 1 && !first_of_row) {
    s.fail(IssueKind::kMeaningless, "one_rank");
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Id id = ids[i];
    if (s.isDenial()) {
      deny(s, location, id);
      continue;
    }
    if (!u.word("moved").empty()) forgetWhereItWas(s, id);
    if (!u.word("instead").empty()) forgetLocation(s, location, id);
    record(s, i == 0 ? location : behindTheLast(location, ids[i - 1], ordered), id);
    takeSizeWord(s, id);
    if (u.number("doors")) takeDoors(s, id);
    if (sized) takeSizes(s, id);
  }
  s.setSubjects(ids);
  // What lies opposite lies on another side than what was spoken of before.
  const bool faces = s.said().find("opposite") != nullptr && !location.in_row;
  if (faces) s.context().side.reset();
  if (ids.size() != 1 || location.relations.size() != 1 || location.in_row) return;
  const DescribedRelation& only = location.relations.front();
  if (only.c == 0) s.context().pair = {ids.front(), only.a == kItself ? only.b : only.a};
}

}  // namespace statements
}  // namespace hyselam_topo

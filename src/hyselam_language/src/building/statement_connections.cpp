// What statements of several places tell: which are joined, on which side, how else they lie.
#include <algorithm>
#include <map>

#include "edit_description.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"
#include "record_facts.hpp"
#include "said_places.hpp"
#include "statement_kinds.hpp"

namespace hyselam_topo {
namespace statements {
namespace {

/// More than anybody counts; checkDescription() allows no more.
constexpr double kMaxRank = 1000.0;

const std::map<std::string, RelationKind>& relationIntents() {
  static const std::map<std::string, RelationKind> kRelations{{"next_to", RelationKind::kNextTo},
                                                              {"opposite", RelationKind::kOpposite},
                                                              {"between", RelationKind::kBetween},
                                                              {"at_end_of", RelationKind::kAtEndOf},
                                                              {"part_of", RelationKind::kInside}};
  return kRelations;
}

void denySide(Statement& s, Id from, Side side, const std::vector<Id>& ids) {
  for (const Id id : ids) {
    DescribedRelation denial = relationOf(RelationKind::kAtSide, id, from);
    denial.side = side;
    if (side == Side::kUnknown) denial.kind = RelationKind::kJoined;
    recordDenial(s, denial);
  }
}

/// "No, the kitchen leads to the pantry": instead of what the last statement joined with it.
void forgetLastJoined(Statement& s, Id place) {
  const DescribedBuilding* before = s.listener().before_last;
  if (before == nullptr) return;
  std::vector<DescribedConnection> last;
  for (const DescribedConnection& each : s.building().connections) {
    const bool of_place = each.from == place || each.to == place;
    const bool plain = each.side == Side::kUnknown && !each.rank && !each.distance;
    if (of_place && plain && findConnection(*before, each.from, each.to) == nullptr) {
      last.push_back(each);
    }
  }
  for (const DescribedConnection& each : last) {
    removeConnection(each, &s.building());
    s.setCorrected();
  }
}

/// "There is a door between the two."
void bothJoined(Statement& s) {
  std::vector<Id> both = placesOf(s, "both");
  // "The lab is next to the bar. There is a door between them."
  const bool them = s.said().names("both").front().reference == "they";
  if (them && both.size() == 1 && s.context().pair.size() == 2) both = s.context().pair;
  if (both.size() != 2) s.fail(IssueKind::kAsk, "between_what");
  if (s.isDenial()) {
    recordDenial(s, relationOf(RelationKind::kJoined, both[0], both[1]));
  } else {
    recordConnection(s, Placement(both[0], both[1]));
  }
  s.setSubjects(both);
}

/// "The main corridor", where the robot is in the corridor and no other one is known by that name.
bool meansRobotPlace(Statement& s, const SaidName& name) {
  const auto robot = s.building().robot_place;
  if (!robot || !name.reference.empty() || name.elliptic || name.speaker) return false;
  const PlaceNames& names = s.listener().names;
  const std::string known = hyselam::utf8Fold(s.nameOf(*robot));
  return placesOf(name.text, s.state(), names).empty() && names.headOf(name.text) == known &&
         std::none_of(s.building().places.begin(), s.building().places.end(),
                      [&](const DescribedPlace& each) {
                        return each.id != *robot && names.headOf(each.name) == known;
                      });
}

}  // namespace

Id observer(Statement& s) {
  const auto robot = s.building().robot_place;
  if (s.said().find("from") == nullptr) {
    if (!robot) s.fail(IssueKind::kNoContext, "no_robot");
    return *robot;
  }
  const std::vector<SaidName> said = s.said().names("from");
  if (said.size() == 1 && meansRobotPlace(s, said[0])) return *robot;
  const Id from = placeOf(s, "from");
  if (robot && from != *robot) {
    s.fail(IssueKind::kNoContext, "elsewhere",
           {{"robot", s.nameOf(*robot)}, {"from", s.nameOf(from)}, {"from", s.nameOf(from)}});
  }
  return from;
}

namespace {

/// On which side of the robot's place a place was told to lie, seen as now.
std::optional<Side> sideToldOf(Statement& s, Id place) {
  const auto robot = s.building().robot_place;
  const DescribedConnection* found = robot ? findConnection(s.building(), *robot, place) : nullptr;
  const bool sided = found != nullptr && found->from == *robot && found->side != Side::kUnknown &&
                     lookAlike(found->seen_from, s.listener().viewpoint);
  return sided ? std::optional(found->side) : std::nullopt;
}

/// "The same side": that of the place it is told with ("after the bar, on the same side"), else of
/// what was spoken of last, else the side told last.
std::optional<Side> sameSide(Statement& s) {
  for (const char* slot : {"after", "before", "next_to"}) {
    if (s.said().find(slot) == nullptr) continue;
    const std::vector<Id> ids = placesOf(s, slot);
    return ids.size() == 1 ? sideToldOf(s, ids.front()) : std::nullopt;
  }
  std::optional<Side> side;
  for (const Id id : s.context().subjects) {
    const std::optional<Side> each = sideToldOf(s, id);
    if (each && side && *each != *side) return std::nullopt;
    if (each) side = each;
  }
  return side ? side : s.context().side;
}

}  // namespace

bool takeSide(Statement& s, Side* side) {
  std::optional<Side>& last = s.context().side;
  const std::string word = s.said().word("side");
  if (word == "same") {
    last = sameSide(s);
    const bool with_place = s.said().find("after") != nullptr ||
                            s.said().find("before") != nullptr ||
                            s.said().find("next_to") != nullptr;
    if (!last && !with_place) s.fail(IssueKind::kNoContext, "no_side");
    if (!last) s.report(IssueKind::kNotice, "same_side_left_out");
    if (last) *side = *last;
    return last.has_value();
  }
  *side = hyselam_topo::sideOf(word).value_or(Side::kUnknown);
  last = *side == Side::kUnknown ? std::nullopt : std::optional(*side);
  return true;
}

Side sideOf(Statement& s) {
  Side side = Side::kUnknown;
  if (!takeSide(s, &side)) s.fail(IssueKind::kNoContext, "no_side");
  return side;
}

void takeHere(Statement& s, Placement* placement) {
  const bool across = placement->side == Side::kLeft || placement->side == Side::kRight;
  const bool first = !placement->rank || *placement->rank == 1;
  const auto names = s.said().names(s.said().find("places") != nullptr ? "places" : "place");
  const bool one = names.size() == 1 || (names.size() > 1 && names[1].follows);
  const bool pointed =
      s.listener().viewpoint && across && first && one && !placement->distance && !s.isDenial();
  if (s.said().word("here").empty() || !pointed) return;
  placement->rank.reset();
  placement->distance = 0.0;
}

std::optional<int> rankOf(Statement& s) {
  const Utterance& u = s.said();
  if (u.find("nth") == nullptr) return std::nullopt;
  double nth = u.number("nth").value_or(0.0);
  if (!u.word("nth").empty()) nth = hyselam::parseNumber(u.word("nth")).value_or(0.0);
  if (!u.word("from_end").empty()) nth = -nth;
  if (nth == 0.0 || nth < -kMaxRank || nth > kMaxRank) {
    s.fail(IssueKind::kMeaningless, "out_of_range", {{"value", shown(nth)}});
  }
  return static_cast<int>(nth);
}

void neighbours(Statement& s) {
  const Side side = sideOf(s);
  const Id from = observer(s);
  const std::vector<Id> ids = countedPlaces(s);
  if (s.isDenial()) {
    denySide(s, from, side, ids);
    return s.setSubjects(ids);
  }
  const auto rank = rankOf(s);
  if (rank && ids.size() != 1) s.fail(IssueKind::kMeaningless, "one_rank");
  for (const Id id : ids) {
    Placement placement;
    placement.from = from;
    placement.to = id;
    placement.side = side;
    placement.rank = rank;
    if (id == ids.front()) takeHere(s, &placement);
    recordConnection(s, placement);
  }
  if (ids.size() == 1 && s.said().number("length")) takeSizes(s, ids.front());
  s.setSubjects(ids);
}

void contains(Statement& s) {
  const Id inside = placeOf(s, "inside");
  const std::vector<Id> ids = placesOf(s, "places");
  if (s.isCorrection()) forgetLastJoined(s, inside);
  if (s.isDenial()) {
    denySide(s, inside, Side::kUnknown, ids);
  } else {
    for (const Id id : ids) recordConnection(s, Placement(inside, id));
  }
  s.setSubjects(ids);
}

void joined(Statement& s) {
  if (s.said().find("both") != nullptr) return bothJoined(s);
  const Id a = placeOf(s, "a");
  const std::vector<Id> to = placesOf(s, "b");
  if (s.isCorrection()) forgetLastJoined(s, a);
  std::vector<Id> subjects{a};
  for (const Id b : to) {
    if (s.isDenial()) {
      recordDenial(s, relationOf(RelationKind::kJoined, a, b));
    } else {
      recordConnection(s, Placement(a, b));
    }
    // "It has a door to the terrace": "it" stays what it was.
    if (s.said().names("a").front().reference.empty()) subjects.push_back(b);
  }
  s.setSubjects(subjects);
}

void row(Statement& s) {
  const std::vector<Id> ids = placesOf(s, "places");
  if (ids.size() < 2) s.fail(IssueKind::kMeaningless, "row_of_one");
  if (s.isDenial()) refuseDenial(s);
  for (std::size_t i = 1; i < ids.size(); ++i) {
    recordRelation(s, relationOf(RelationKind::kNextTo, ids[i - 1], ids[i]));
  }
  s.setSubjects(ids);
}

void eachSide(Statement& s) {
  if (s.isDenial()) refuseDenial(s);
  const Id from = observer(s);
  const auto names = s.said().names("places");
  if (names.size() != 1) s.fail(IssueKind::kAsk, "which_side");
  const double count = s.said().number("count").value_or(2.0);
  const std::vector<Id> ids =
      names[0].reference.empty() ? placesOfOneName(s, names[0], count) : placesOf(s, "places");
  if (ids.size() % 2 != 0) {
    s.fail(IssueKind::kMeaningless, "odd_count", {{"count", std::to_string(ids.size())}});
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Placement placement;
    placement.from = from;
    placement.to = ids[i];
    placement.side = 2 * i < ids.size() ? Side::kLeft : Side::kRight;
    recordConnection(s, placement);
  }
  s.setSubjects(ids);
}

void larger(Statement& s) {
  const DescribedRelation told =
      relationOf(RelationKind::kLarger, placeOf(s, "a"), placeOf(s, "b"));
  if (s.isDenial()) {
    recordDenial(s, told);
  } else {
    recordRelation(s, told);
  }
  s.setSubjects({told.a});
}

void relation(Statement& s) {
  DescribedRelation told;
  told.kind = relationIntents().at(s.said().intent);
  told.a = placeOf(s, "a");
  told.b = placeOf(s, "b");
  if (told.kind == RelationKind::kBetween) told.c = placeOf(s, "c");
  if (s.isDenial()) {
    recordDenial(s, told);
  } else {
    recordRelation(s, told);
    // Whoever goes to the end of a corridor gets there.
    if (told.kind == RelationKind::kAtEndOf) recordConnection(s, Placement(told.b, told.a));
  }
  s.setSubjects({told.a});
  if (told.kind == RelationKind::kOpposite) s.context().side.reset();
  s.context().pair =
      told.c == 0 ? std::vector<Id>{told.a, told.b} : std::vector<Id>{told.b, told.c};
}

}  // namespace statements
}  // namespace hyselam_topo

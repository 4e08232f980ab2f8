#include "hyselam_topo/description_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam_topo {
namespace {

constexpr double kMaxSize = 10000.0;  // [m]
constexpr double kMaxArea = 1e8;      // [m^2]
/// Rounded areas ("about 50 square metres" of 6 by 8) are no contradiction.
constexpr double kAreaTolerance = 0.1;

const std::map<std::string, RelationKind>& relations() {
  static const std::map<std::string, RelationKind> kRelations{{"next_to", RelationKind::kNextTo},
                                                              {"opposite", RelationKind::kOpposite},
                                                              {"between", RelationKind::kBetween},
                                                              {"at_end_of", RelationKind::kAtEndOf},
                                                              {"part_of", RelationKind::kInside}};
  return kRelations;
}

std::string shown(double value) {
  return hyselam::formatNumber(std::round(value * 1000.0) / 1000.0);
}

}  // namespace

const char* toString(IssueKind kind) {
  constexpr std::array<const char*, 5> kNames{"contradiction", "ambiguous", "no context",
                                              "meaningless", "notice"};
  return kNames.at(static_cast<std::size_t>(kind));
}

DescriptionBuilder::DescriptionBuilder(const TopoParser& parser) : names_(parser.grammars()) {}

void DescriptionBuilder::continueFrom(DescribedBuilding building) {
  checkDescription(building, "description");
  building_ = std::move(building);
  variants_.clear();
  subjects_.clear();
}

bool DescriptionBuilder::handles(const std::string& intent) {
  static const std::array<const char*, 15> kIntents{
      "robot_in", "this_is", "neighbours", "nth_neighbour", "contains",
      "joined",   "alias",   "kind",       "size",          "length_of",
      "width_of", "area",    "parts",      "building",      "exists"};
  return relations().count(intent) != 0 || intent == "forget_place" ||
         std::find(kIntents.begin(), kIntents.end(), intent) != kIntents.end();
}

std::vector<DescriptionIssue> DescriptionBuilder::add(const ParsedText& text) {
  std::vector<DescriptionIssue> all;
  for (const Utterance& utterance : text.utterances) {
    std::vector<DescriptionIssue> issues = add(utterance);
    all.insert(all.end(), issues.begin(), issues.end());
  }
  return all;
}

std::vector<DescriptionIssue> DescriptionBuilder::add(const Utterance& utterance) {
  issues_.clear();
  if (!utterance.understood() || !handles(utterance.intent)) return {};
  current_ = &utterance;
  correction_ = utterance.correction;
  corrected_ = false;
  // A statement that fails half-way leaves nothing behind.
  const DescribedBuilding building = building_;
  const auto variants = variants_;
  const auto subjects = subjects_;
  const auto restore = [&] {
    building_ = building;
    variants_ = variants;
    subjects_ = subjects;
  };
  try {
    dispatch(utterance);
    const bool may_correct = utterance.intent != "robot_in" && utterance.intent != "this_is";
    if (correction_ && !corrected_ && may_correct && !(building_ == building)) {
      restore();
      report(IssueKind::kNoContext, "nothing was told that this corrects");
    }
  } catch (const Failed&) {
    restore();
  }
  return std::move(issues_);
}

void DescriptionBuilder::dispatch(const Utterance& u) {
  const auto is = [&u](const char* intent) { return u.intent == intent; };
  const auto found = relations().find(u.intent);
  if (found != relations().end()) return relation(u, found->second);
  if (is("robot_in") || is("this_is")) return robotIn(u);
  if (is("neighbours")) return neighbours(u);
  if (is("nth_neighbour")) return nthNeighbour(u);
  if (is("contains")) return contains(u);
  if (is("joined")) return joined(u);
  if (is("alias")) return alias(u);
  if (is("kind")) return kind(u);
  if (is("parts")) return parts(u);
  if (is("building")) return buildingCount(u);
  if (is("exists")) return exists(u);
  if (is("forget_place")) return forget(u);
  size(u);
}

// ---- Names ----

std::vector<Id> DescriptionBuilder::find(const std::string& name) const {
  std::vector<std::vector<std::string>> all;
  for (const DescribedPlace& place : building_.places) {
    all.push_back({place.name});
    all.back().insert(all.back().end(), place.aliases.begin(), place.aliases.end());
    const auto variants = variants_.find(place.id);
    if (variants == variants_.end()) continue;
    all.back().insert(all.back().end(), variants->second.begin(), variants->second.end());
  }
  std::vector<Id> ids;
  for (const std::size_t i : names_.find(name, all)) ids.push_back(building_.places[i].id);
  return ids;
}

Id DescriptionBuilder::place(const SaidName& name) {
  if (name.reference == "here") {
    if (!building_.robot_place) fail(IssueKind::kNoContext, "where the robot is was not told");
    return *building_.robot_place;
  }
  if (!name.reference.empty()) {
    if (subjects_.size() != 1) {
      fail(subjects_.empty() ? IssueKind::kNoContext : IssueKind::kAmbiguous,
           "'" + name.text + "' may mean " + (subjects_.empty() ? "nothing" : "several places"));
    }
    return subjects_.front();
  }
  const std::vector<Id> ids = find(name.text);
  if (ids.size() > 1) {
    std::string which;
    for (const Id id : ids) which += (which.empty() ? "'" : ", '") + nameOf(id) + "'";
    fail(IssueKind::kAmbiguous, "'" + name.text + "' may mean " + which);
  }
  if (ids.size() == 1) {
    const DescribedPlace* known = building_.findPlace(ids.front());
    if (known->name != name.text) {
      auto& variants = variants_[known->id];
      if (std::find(variants.begin(), variants.end(), name.text) == variants.end()) {
        variants.push_back(name.text);
      }
    }
    return ids.front();
  }
  DescribedPlace made;
  for (const DescribedPlace& other : building_.places) made.id = std::max(made.id, other.id);
  ++made.id;  // descriptions from files come in any order
  made.name = name.text;
  made.kind = names_.kindOf(name.text);
  building_.places.push_back(made);
  return made.id;
}

Id DescriptionBuilder::place(const Utterance& u, const std::string& slot) {
  const std::vector<Id> ids = places(u, slot);
  if (ids.size() != 1) fail(IssueKind::kMeaningless, "here must be one place");
  return ids.front();
}

std::vector<Id> DescriptionBuilder::places(const Utterance& u, const std::string& slot) {
  std::vector<Id> ids;
  for (const SaidName& name : u.names(slot)) ids.push_back(place(name));
  return ids;
}

std::string DescriptionBuilder::nameOf(Id id) const {
  const DescribedPlace* found = building_.findPlace(id);
  return found == nullptr ? "" : found->name;
}

void DescriptionBuilder::setRobotPlace(const std::string& name) {
  SaidName said;
  said.text = name;
  const Utterance nothing;
  current_ = &nothing;
  try {
    building_.robot_place = place(said);
    subjects_ = {*building_.robot_place};
  } catch (const Failed&) {
    throw hyselam::InputError("robot's place", "", issues_.back().reason);
  }
}

void DescriptionBuilder::report(IssueKind issue, const std::string& reason) {
  issues_.push_back({issue, reason, current_->text, current_->range});
}

void DescriptionBuilder::fail(IssueKind issue, const std::string& reason) {
  report(issue, reason);
  throw Failed();
}

// ---- Statements ----

void DescriptionBuilder::robotIn(const Utterance& u) {
  const Id id = place(u, "place");
  if (building_.robot_place != id) side_.reset();
  building_.robot_place = id;
  subjects_ = {id};
  addAliases(u, id);
}

void DescriptionBuilder::addAliases(const Utterance& u, Id id) {
  for (const SaidName& name : u.names("aliases")) {
    if (!name.reference.empty()) fail(IssueKind::kMeaningless, "'" + name.text + "' is no name");
    const std::vector<Id> ids = find(name.text);
    if (std::find(ids.begin(), ids.end(), id) != ids.end()) continue;
    if (!ids.empty()) {
      fail(IssueKind::kContradiction,
           "'" + name.text + "' is another place than '" + nameOf(id) + "'");
    }
    DescribedPlace* place = building_.findPlace(id);
    place->aliases.push_back(name.text);
    if (!place->kind) place->kind = names_.kindOf(name.text);
  }
}

void DescriptionBuilder::alias(const Utterance& u) {
  const auto said = u.names("place");
  const auto aliases = u.names("aliases");
  // "The fish tank is also called C12", where only C12 is known.
  const bool swapped = said.size() == 1 && aliases.size() == 1 && said[0].reference.empty() &&
                       aliases[0].reference.empty() && find(said[0].text).empty() &&
                       find(aliases[0].text).size() == 1;
  if (swapped) {
    const Id id = find(aliases[0].text).front();
    building_.findPlace(id)->aliases.push_back(said[0].text);
    subjects_ = {id};
    return;
  }
  const Id id = place(u, "place");
  addAliases(u, id);
  subjects_ = {id};
}

void DescriptionBuilder::checkCount(const Utterance& u, std::size_t named) {
  const auto count = u.number("count");
  if (count && static_cast<std::size_t>(*count) != named) {
    fail(IssueKind::kMeaningless,
         shown(*count) + " were announced, " + std::to_string(named) + " named");
  }
}

void DescriptionBuilder::neighbours(const Utterance& u) {
  const bool same = u.word("side") == "same";
  if (same && !side_) fail(IssueKind::kNoContext, "no side was told before");
  const auto side = same ? side_ : sideOf(u.word("side"));
  if (u.find("from") == nullptr && !building_.robot_place) {
    fail(IssueKind::kNoContext, "where the robot is was not told");
  }
  const Id from = u.find("from") != nullptr ? place(u, "from") : *building_.robot_place;
  if (building_.robot_place && from != *building_.robot_place) {
    fail(IssueKind::kNoContext, "sides are told as the robot sees them, and it is in '" +
                                    nameOf(*building_.robot_place) + "', not in '" + nameOf(from) +
                                    "'");
  }
  const std::vector<Id> ids = places(u, "places");
  checkCount(u, ids.size());
  side_ = side && *side != Side::kUnknown ? side : std::nullopt;
  for (const Id id : ids) connect(from, id, side.value_or(Side::kUnknown), std::nullopt);
  subjects_ = ids;
  if (ids.size() == 1 && u.number("length")) sizeOf(ids.front(), u);
}

void DescriptionBuilder::nthNeighbour(const Utterance& u) {
  if (!building_.robot_place) fail(IssueKind::kNoContext, "where the robot is was not told");
  const Id id = place(u, "place");
  const auto nth = hyselam::parseNumber(u.word("nth")).value_or(1.0);
  side_ = sideOf(u.word("side"));
  connect(*building_.robot_place, id, side_.value_or(Side::kUnknown),
          static_cast<std::size_t>(nth) - 1);
  subjects_ = {id};
}

void DescriptionBuilder::contains(const Utterance& u) {
  const Id inside = place(u, "inside");
  const std::vector<Id> ids = places(u, "places");
  for (const Id id : ids) connect(inside, id, Side::kUnknown, std::nullopt);
  subjects_ = ids;
}

void DescriptionBuilder::joined(const Utterance& u) {
  const Id a = place(u, "a");
  const Id b = place(u, "b");
  connect(a, b, Side::kUnknown, std::nullopt);
  subjects_ = {a, b};
}

DescribedConnection* DescriptionBuilder::connectionOf(Id a, Id b) {
  const auto found = std::find_if(
      building_.connections.begin(), building_.connections.end(), [&](const auto& connection) {
        return std::minmax(connection.from, connection.to) == std::minmax(a, b);
      });
  return found == building_.connections.end() ? nullptr : &*found;
}

void DescriptionBuilder::removeConnection(std::size_t index) {
  const auto at = building_.connections.begin() + static_cast<std::ptrdiff_t>(index);
  const DescribedConnection gone = *at;
  building_.connections.erase(at);
  for (DescribedConnection& other : building_.connections) {
    const bool same_row = other.from == gone.from && other.side == gone.side;
    if (same_row && other.order > gone.order) --other.order;
  }
}

void DescriptionBuilder::connect(Id from, Id to, Side side, std::optional<std::size_t> order) {
  if (from == to) {
    fail(IssueKind::kMeaningless, "'" + nameOf(to) + "' lies beside itself");
  }
  if (const DescribedConnection* known = connectionOf(from, to)) {
    // Nothing new: told already, told without a side, or seen from the other place.
    if (side == Side::kUnknown) return;
    const bool seen_from_there = known->from == to && known->side != Side::kUnknown;
    if (seen_from_there) return;
    if (known->from == from && known->side == side && (!order || known->order == *order)) return;
    if (known->side != Side::kUnknown) {
      if (!correction_) {
        report(IssueKind::kContradiction, "'" + nameOf(to) + "' was told to be at the " +
                                              toString(known->side) + ", not at the " +
                                              toString(side));
        return;
      }
      corrected_ = true;
    }
    removeConnection(static_cast<std::size_t>(known - building_.connections.data()));
  }
  std::size_t next = 0;
  bool taken = false;
  for (const DescribedConnection& other : building_.connections) {
    if (other.from != from || other.side != side) continue;
    next = std::max(next, other.order + 1);
    taken = taken || (order && other.order == *order);
  }
  if (taken) {
    fail(IssueKind::kContradiction, "number " + std::to_string(*order + 1) + " at the " +
                                        toString(side) + " is another place");
  }
  building_.connections.push_back({from, to, side, order.value_or(next)});
}

void DescriptionBuilder::relation(const Utterance& u, RelationKind kind) {
  DescribedRelation relation;
  relation.kind = kind;
  relation.a = place(u, "a");
  relation.b = place(u, "b");
  if (kind == RelationKind::kBetween) relation.c = place(u, "c");
  if (relation.a == relation.b || relation.a == relation.c || relation.b == relation.c) {
    fail(IssueKind::kMeaningless, "a place is named twice");
  }
  auto& all = building_.relations;
  if (std::find(all.begin(), all.end(), relation) == all.end()) all.push_back(relation);
  // Whoever goes to the end of a corridor gets there.
  if (kind == RelationKind::kAtEndOf) connect(relation.b, relation.a, Side::kUnknown, std::nullopt);
  subjects_ = {relation.a};
}

void DescriptionBuilder::kind(const Utterance& u) {
  const Id id = place(u, "place");
  building_.findPlace(id)->kind = placeKindOf(u.word("kind"));
  corrected_ = true;
  subjects_ = {id};
}

void DescriptionBuilder::setSize(std::optional<double>* member, const std::optional<double>& value,
                                 const std::string& what) {
  if (!value) return;
  const double limit = what == "area" ? kMaxArea : kMaxSize;
  if (!(*value > 0.0) || *value > limit) {
    fail(IssueKind::kMeaningless, "a " + what + " of " + shown(*value) + " is out of range");
  }
  const double tolerance = what == "area" ? kAreaTolerance * *value : 1e-9;
  if (*member && std::abs(**member - *value) > tolerance) {
    if (!correction_) {
      fail(IssueKind::kContradiction,
           "another " + what + " was told: " + shown(**member) + ", not " + shown(*value));
    }
    corrected_ = true;
  } else if (*member) {
    return;
  }
  *member = value;
}

void DescriptionBuilder::size(const Utterance& u) {
  sizeOf(place(u, "place"), u);
}

void DescriptionBuilder::sizeOf(Id id, const Utterance& u) {
  DescribedPlace& place = *building_.findPlace(id);
  subjects_ = {id};
  const auto length = u.number("length"), width = u.number("width"), area = u.number("area");
  setSize(&place.length, length, "length");
  setSize(&place.width, width, "width");
  setSize(&place.area, area, "area");
  if ((length || width) && place.length && place.width) {
    const double product = *place.length * *place.width;
    if (corrected_) place.area.reset();
    setSize(&place.area, product, "area");
    place.area = product;
  }
  for (const Slot& slot : u.slots) {
    if (!slot.unit_assumed) continue;
    report(IssueKind::kNotice, "no unit was said: taken as metres");
    break;
  }
}

void DescriptionBuilder::parts(const Utterance& u) {
  const Id id = place(u, "place");
  DescribedPlace& place = *building_.findPlace(id);
  const int count = static_cast<int>(u.number("count").value_or(1.0));
  if (place.parts && *place.parts != count) {
    if (!correction_) {
      fail(IssueKind::kContradiction, std::to_string(*place.parts) + " parts were told");
    }
    corrected_ = true;
  }
  place.parts = count;
  subjects_ = {id};
}

void DescriptionBuilder::buildingCount(const Utterance& u) {
  const int count = static_cast<int>(u.number("count").value_or(1.0));
  if (building_.place_count && *building_.place_count != count) {
    if (!correction_) {
      fail(IssueKind::kContradiction, std::to_string(*building_.place_count) + " were told");
    }
    corrected_ = true;
  }
  building_.place_count = count;
}

void DescriptionBuilder::exists(const Utterance& u) {
  subjects_ = places(u, "places");
}

void DescriptionBuilder::forget(const Utterance& u) {
  for (const SaidName& name : u.names("place")) {
    if (name.reference.empty() && find(name.text).empty()) {
      fail(IssueKind::kNoContext, "'" + name.text + "' was not told of");
    }
  }
  const Id id = place(u, "place");
  corrected_ = true;
  for (std::size_t i = building_.connections.size(); i-- > 0;) {
    const DescribedConnection& each = building_.connections[i];
    if (each.from == id || each.to == id) removeConnection(i);
  }
  auto& all = building_.relations;
  all.erase(std::remove_if(
                all.begin(), all.end(),
                [id](const auto& each) { return each.a == id || each.b == id || each.c == id; }),
            all.end());
  auto& list = building_.places;
  list.erase(
      std::remove_if(list.begin(), list.end(), [id](const auto& each) { return each.id == id; }),
      list.end());
  variants_.erase(id);
  subjects_.clear();
  if (building_.robot_place == id) building_.robot_place.reset();
}

}  // namespace hyselam_topo

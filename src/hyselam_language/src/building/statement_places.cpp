// What statements of a place tell: where the robot is, other names, kind and size, that it is
// there, that it is gone.
#include <algorithm>
#include <cmath>
#include <limits>

#include "edit_description.hpp"
#include "record_facts.hpp"
#include "said_places.hpp"
#include "sentence_writer.hpp"
#include "statement_kinds.hpp"

namespace hyselam_topo {
namespace statements {
namespace {

constexpr double kMaxSize = 10000.0;  // [m]
constexpr double kMaxArea = 1e8;      // [m^2]
/// Rounded areas ("about 50 square metres" of 6 by 8) are no contradiction.
constexpr double kAreaTolerance = 0.1;

/// `what`: "length", "width" or "area".
void setSize(Statement& s, std::optional<double>* member, const std::optional<double>& value,
             const std::string& what) {
  if (!value) return;
  const bool is_area = what == "area";
  if (!(*value > 0.0) || *value > (is_area ? kMaxArea : kMaxSize)) {
    s.fail(IssueKind::kMeaningless, what + "_range", {{"value", shown(*value)}});
  }
  const double tolerance = is_area ? kAreaTolerance * *value : 1e-9;
  if (*member && std::abs(**member - *value) <= tolerance) return;
  if (*member) s.replaces("other_" + what, {{"known", shown(**member)}, {"value", shown(*value)}});
  *member = value;
}

/// A number that was said; one known before is replaced by a correction only.
void takeCount(Statement& s, const std::string& slot, const std::string& other,
               std::optional<int>* known) {
  const double said = s.said().number(slot).value_or(1.0);
  if (!(said >= 1.0) || said > static_cast<double>(std::numeric_limits<int>::max())) {
    s.fail(IssueKind::kMeaningless, "out_of_range", {{"value", shown(said)}});
  }
  const int count = static_cast<int>(said);
  if (*known && **known != count) {
    s.replaces(other, {{"known", std::to_string(**known)}, {"count", std::to_string(count)}});
  }
  *known = count;
}

/// "You are not in the kitchen."
void robotNotIn(Statement& s) {
  const Id id = knownPlacesOf(s, "place").front();
  if (s.building().robot_place == id) s.building().robot_place.reset();
  s.setCorrected();
  s.setSubjects({id});
}

/// "Room 3 is not John's office."
void notAlias(Statement& s) {
  const Id id = knownPlacesOf(s, "place").front();
  auto& aliases = s.at(id).aliases;
  const PlaceNames& names = s.listener().names;
  const std::size_t before = aliases.size();
  for (const SaidName& name : s.said().names("aliases")) {
    const NameKey key = names.key(fullName(s, name));
    const auto isMeant = [&](const std::string& each) {
      return compare(names.key(each), key) == SameName::kYes;
    };
    aliases.erase(std::remove_if(aliases.begin(), aliases.end(), isMeant), aliases.end());
  }
  if (aliases.size() == before) s.fail(IssueKind::kNoContext, "not_told");
  s.setCorrected();
  s.setSubjects({id});
}

/// "The next one is the lab": behind the place that the last statement was about, in its row.
void nextIs(Statement& s) {
  if (s.context().subjects.empty()) {
    s.fail(IssueKind::kNoContext, "it_nothing", {{"name", s.said().names("place")[0].text}});
  }
  const Id last = s.context().subjects.back();
  const Id id = placeOf(s, "aliases");
  const Id robot = s.building().robot_place.value_or(0);
  recordNext(s, id, last, robot == id || robot == last ? 0 : robot);
  s.setSubjects({id});
}

}  // namespace

void refuseDenial(Statement& s) {
  s.fail(IssueKind::kMeaningless, "not_told");
}

void robotIn(Statement& s) {
  if (s.isDenial()) return robotNotIn(s);
  const Id id = placeOf(s, "place");
  if (s.building().robot_place != id) s.context().side.reset();
  s.building().robot_place = id;
  s.setCorrected();
  s.setSubjects({id});
  for (const SaidName& name : s.said().names("aliases")) addAlias(s, id, name);
}

void addAlias(Statement& s, Id id, const SaidName& name) {
  if (!name.reference.empty()) s.fail(IssueKind::kMeaningless, "no_name", {{"name", name.text}});
  const std::string full = fullName(s, name);
  const std::vector<Id> ids = placesOf(full, s.state(), s.listener().names);
  if (std::find(ids.begin(), ids.end(), id) != ids.end()) return;
  if (!ids.empty()) {
    s.fail(IssueKind::kContradiction, "other_place", {{"name", full}, {"place", s.nameOf(id)}});
  }
  s.at(id).aliases.push_back(full);
  if (!s.at(id).kind) s.at(id).kind = s.listener().names.kindOf(full);
}

void alias(Statement& s) {
  const auto said = s.said().names("place");
  const auto aliases = s.said().names("aliases");
  if (said.size() == 1 && said[0].reference == "next") return nextIs(s);
  if (s.isDenial()) return notAlias(s);
  const auto known = [&](const SaidName& name) {
    return placesOf(fullName(s, name), s.state(), s.listener().names);
  };
  // "The fish tank is also called C12", where only C12 is known.
  const bool plain = said.size() == 1 && aliases.size() == 1 && said[0].reference.empty() &&
                     aliases[0].reference.empty();
  if (plain && known(said[0]).empty() && known(aliases[0]).size() == 1) {
    const Id id = known(aliases[0]).front();
    s.at(id).aliases.push_back(fullName(s, said[0]));
    return s.setSubjects({id});
  }
  const Id id = placeOf(s, "place");
  for (const SaidName& name : aliases) addAlias(s, id, name);
  s.setSubjects({id});
}

void owner(Statement& s) {
  const Id id = placeOf(s, "place");
  const Grammar& grammar = s.listener().grammar;
  const PlaceNames& names = s.listener().names;
  // "Tom's lab" of a lab, "Tom's office" of a room.
  const std::string name = s.nameOf(id);
  const std::string kind = names.isPlainRoom(name) ? grammar.say("office") : names.headOf(name);
  for (SaidName each : s.said().names("owners")) {
    each.text =
        SentenceWriter(grammar, false)
            .phrase("owned", {{"owner", each.text, false, true}, {"kind", kind, false, true}});
    each.reference.clear();
    addAlias(s, id, each);
  }
  s.setSubjects({id});
}

void kind(Statement& s) {
  const Id id = placeOf(s, "place");
  const auto told = placeKindFromString(s.said().word("kind"));
  if (s.isDenial()) {
    if (s.at(id).kind != told) refuseDenial(s);
    s.at(id).kind.reset();
  } else {
    s.at(id).kind = told;
  }
  s.setCorrected();
  s.setSubjects({id});
}

void size(Statement& s) {
  if (s.isDenial()) refuseDenial(s);
  const Id id = placeOf(s, "place");
  takeSizes(s, id);
  s.setSubjects({id});
}

void takeSizes(Statement& s, Id id) {
  DescribedPlace& place = s.at(id);
  const Utterance& u = s.said();
  const auto length = u.number("length"), width = u.number("width"), area = u.number("area");
  setSize(s, &place.length, length, "length");
  setSize(s, &place.width, width, "width");
  setSize(s, &place.area, area, "area");
  if ((length || width) && place.length && place.width) {
    const double product = *place.length * *place.width;
    if (s.hasCorrected()) place.area.reset();
    setSize(s, &place.area, product, "area");
    place.area = product;
  }
  for (const Slot& slot : u.slots) {
    if (!slot.unit_assumed) continue;
    s.report(IssueKind::kNotice, "metres");
    break;
  }
}

void takeSizeWord(Statement& s, Id id) {
  const auto word = sizeWordOf(s.said().word("size_word"));
  if (!word) return;
  std::optional<SizeWord>& known = s.at(id).size_word;
  if (s.isDenial()) {
    if (known != word) refuseDenial(s);
    known.reset();
    return s.setCorrected();
  }
  if (known && known != word) s.replaces("other_size_word", {{"place", s.nameOf(id)}});
  known = word;
}

void sizeWord(Statement& s) {
  const std::vector<Id> ids = placesOf(s, "place");
  for (const Id id : ids) takeSizeWord(s, id);
  s.setSubjects(ids);
}

void parts(Statement& s) {
  if (s.isDenial()) refuseDenial(s);
  const Id id = placeOf(s, "place");
  takeCount(s, "count", "other_parts", &s.at(id).parts);
  s.setSubjects({id});
}

void buildingCount(Statement& s) {
  if (s.isDenial()) refuseDenial(s);
  takeCount(s, "count", "other_count", &s.building().place_count);
}

void takeDoors(Statement& s, Id id) {
  takeCount(s, "doors", "other_doors", &s.at(id).doors);
}

void doors(Statement& s) {
  if (s.isDenial()) refuseDenial(s);
  const Id id = placeOf(s, "place");
  takeDoors(s, id);
  const std::vector<Id> to = placesOf(s, "to");
  if (static_cast<int>(to.size()) > *s.at(id).doors) {
    s.fail(IssueKind::kMeaningless, "more_doors",
           {{"count", std::to_string(*s.at(id).doors)}, {"named", std::to_string(to.size())}});
  }
  for (const Id other : to) recordConnection(s, Placement(id, other));
  s.setSubjects({id});
}

void exists(Statement& s) {
  if (s.isDenial()) return gone(s);
  const auto count = s.said().number("count");
  const auto names = s.said().names("places");
  if (!count || names.size() != 1 || !names[0].reference.empty()) {
    if (count) checkCount(s, names.size());
    return s.setSubjects(placesOf(s, "places"));
  }
  s.setSubjects(placesOfOneName(s, names[0], *count));
}

void gone(Statement& s) {
  const std::string slot = s.said().find("places") != nullptr ? "places" : "place";
  for (const Id id : knownPlacesOf(s, slot)) {
    removePlace(id, &s.building());
    s.context().variants.erase(id);
  }
  s.setCorrected();
  s.setSubjects({});
}

}  // namespace statements
}  // namespace hyselam_topo

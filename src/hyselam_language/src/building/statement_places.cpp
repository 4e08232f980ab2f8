// What statements of a place tell: where the robot is, other names, kind and size, that it is
// there, that it is gone.
#include <algorithm>
#include <cmath>
#include <limits>

#include "edit_description.hpp"
#include "hyselam_common/numbers.hpp"
#include "record_facts.hpp"
#include "said_places.hpp"
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
  const auto word = hyselam::parseNumber(s.said().word(slot));
  const double said = s.said().number(slot).value_or(word.value_or(1.0));
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

/// "This used to be the library, now it is the lab": where the robot is has a new name.
void renameRobotPlace(Statement& s) {
  const auto was = s.said().names("was"), now = s.said().names("place");
  const auto robot = s.building().robot_place;
  if (was.size() != 1 || now.size() != 1 || !robot || !now[0].reference.empty()) return;
  const PlaceNames& names = s.listener().names;
  const std::vector<Id> known = placesOf(fullName(s, was[0]), s.state(), names);
  const std::string full = fullName(s, now[0]);
  if (known != std::vector<Id>{*robot} || !placesOf(full, s.state(), names).empty()) return;
  checkName(s, now[0], full);
  DescribedPlace& place = s.at(*robot);
  if (place.kind == names.kindOf(place.name)) place.kind = names.kindOf(full);
  place.name = full;
  s.context().variants.erase(*robot);
  s.setCorrected();
}

}  // namespace

void refuseDenial(Statement& s) {
  s.fail(IssueKind::kMeaningless, "not_told");
}

void robotIn(Statement& s) {
  if (s.isDenial()) return robotNotIn(s);
  renameRobotPlace(s);
  const Id id = placeOf(s, "place");
  if (s.building().robot_place != id) s.context().side.reset();
  s.building().robot_place = id;
  s.setCorrected();
  s.setSubjects({id});
  for (const SaidName& name : s.said().names("aliases")) addAlias(s, id, name);
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
  s.setSubjects(countedPlaces(s));
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

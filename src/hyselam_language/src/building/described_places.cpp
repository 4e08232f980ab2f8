// What statements of a place tell: where the robot is, other names, kind and size, that it is
// there.
#include <algorithm>
#include <cmath>

#include "edit_description.hpp"
#include "hyselam_language/building/description_builder.hpp"

namespace hyselam_topo {
namespace {

constexpr double kMaxSize = 10000.0;  // [m]
constexpr double kMaxArea = 1e8;      // [m^2]
/// Rounded areas ("about 50 square metres" of 6 by 8) are no contradiction.
constexpr double kAreaTolerance = 0.1;

}  // namespace

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

void DescriptionBuilder::kind(const Utterance& u) {
  const Id id = place(u, "place");
  building_.findPlace(id)->kind = placeKindFromString(u.word("kind"));
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
  takeCount(u, " parts were told", &building_.findPlace(id)->parts);
  subjects_ = {id};
}

void DescriptionBuilder::buildingCount(const Utterance& u) {
  takeCount(u, " were told", &building_.place_count);
}

void DescriptionBuilder::takeCount(const Utterance& u, const std::string& told,
                                   std::optional<int>* known) {
  const int count = static_cast<int>(u.number("count").value_or(1.0));
  if (*known && **known != count) {
    if (!correction_) fail(IssueKind::kContradiction, std::to_string(**known) + told);
    corrected_ = true;
  }
  *known = count;
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
  removePlace(id, &building_);
  variants_.erase(id);
  subjects_.clear();
}

}  // namespace hyselam_topo

#include "hyselam_language/building/description_builder.hpp"

#include <algorithm>
#include <array>

#include "edit_description.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace {

const std::map<std::string, RelationKind>& relations() {
  static const std::map<std::string, RelationKind> kRelations{{"next_to", RelationKind::kNextTo},
                                                              {"opposite", RelationKind::kOpposite},
                                                              {"between", RelationKind::kBetween},
                                                              {"at_end_of", RelationKind::kAtEndOf},
                                                              {"part_of", RelationKind::kInside}};
  return kRelations;
}

/// Points to what is said for as long as this lives.
class Saying {
 public:
  Saying(const Utterance** current, const Utterance& said) : current_(*current) {
    current_ = &said;
  }
  ~Saying() { current_ = nullptr; }
  Saying(const Saying&) = delete;
  Saying& operator=(const Saying&) = delete;

 private:
  const Utterance*& current_;
};

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
  const Saying saying(&current_, utterance);
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
    all.push_back(allNamesOf(place));
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
  return addPlace(name.text, names_.kindOf(name.text), &building_);
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
  const Saying saying(&current_, nothing);
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

}  // namespace hyselam_topo

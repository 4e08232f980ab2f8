#include "hyselam_language/building/description_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "edit_description.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "issue_texts.hpp"
#include "said_places.hpp"
#include "sentence_writer.hpp"
#include "statement.hpp"

namespace hyselam_topo {
namespace {

/// So many statements can be taken back.
constexpr std::size_t kLongestHistory = 32;

DescriptionIssue issueOf(const Utterance& u, IssueKind kind, const std::string& reason) {
  DescriptionIssue issue;
  issue.kind = kind;
  issue.reason = reason;
  issue.text = u.text;
  issue.range = u.range;
  return issue;
}

/// The places that a statement names, not by pronouns.
std::vector<SaidName*> namesIn(Utterance* u) {
  std::vector<SaidName*> names;
  for (Slot& slot : u->slots) {
    for (SaidName& name : slot.names) {
      if (name.reference.empty()) names.push_back(&name);
    }
  }
  return names;
}

/// All that was told of `gone` is of `stays`, and so is what is told of "it".
void join(Id gone, Id stays, DescriptionState* state) {
  joinPlaces(gone, stays, &state->building);
  for (Id& subject : state->context.subjects) {
    if (subject == gone) subject = stays;
  }
}

}  // namespace

const char* toString(IssueKind kind) {
  constexpr std::array<const char*, 7> kNames{
      "contradiction", "ambiguous", "no context", "meaningless", "notice", "ask", "strange name"};
  return kNames.at(static_cast<std::size_t>(kind));
}

void DescriptionContext::forgetReferences() {
  subjects.clear();
  pair.clear();
  group.clear();
  told_of_group.clear();
  side.reset();
  kind_word.clear();
  described_kind.clear();
  owned_kind.clear();
}

DescriptionBuilder::DescriptionBuilder(const TopoParser& parser, const DescriptionParams& params)
    : params_(params), grammars_(parser.grammars()), names_(parser.grammars()) {}

void DescriptionBuilder::continueFrom(DescribedBuilding building) {
  checkDescription(building, "description");
  restore({{std::move(building), {}}, {}, 0});
}

void DescriptionBuilder::restore(Memory memory) {
  state_ = std::move(memory.state);
  history_ = std::move(memory.history);
  statements_ = memory.statements;
}

void DescriptionBuilder::setLanguage(const std::string& language) {
  const auto found = std::find_if(grammars_.begin(), grammars_.end(),
                                  [&](const Grammar& each) { return each.language() == language; });
  if (found == grammars_.end()) {
    throw hyselam::ParameterError("language", language, "a language of the parser");
  }
  language_ = static_cast<std::size_t>(found - grammars_.begin());
}

bool DescriptionBuilder::handles(const std::string& intent) {
  static const std::set<std::string> kOthers{"speaker", "undo", "replace", "replace_number",
                                             "forget_everything"};
  return statementKind(intent) != nullptr || kOthers.count(intent) != 0;
}

std::vector<DescriptionIssue> DescriptionBuilder::add(const ParsedText& text) {
  if (!text.utterances.empty()) setLanguage(text.language);
  std::vector<DescriptionIssue> all;
  for (const Utterance& utterance : text.utterances) {
    std::vector<DescriptionIssue> issues = add(utterance);
    all.insert(all.end(), issues.begin(), issues.end());
  }
  return all;
}

void DescriptionBuilder::sentenceRefused() {
  state_.context.forgetReferences();
  state_.context.after_refusal = true;
}

std::vector<DescriptionIssue> DescriptionBuilder::add(const Utterance& u) {
  if (!u.understood()) sentenceRefused();
  if (!u.understood() || !handles(u.intent)) return {};
  if (u.intent == "speaker") {
    for (const SaidName& name : u.names("person")) setSpeaker(name.text);
    return {};
  }
  if (u.intent == "replace") return replaceLast(u);
  if (u.intent == "replace_number") return replaceNumber(u);
  if (u.intent == "undo") {
    if (undo()) return {};
    return {issueOf(u, IssueKind::kNoContext, issueText(grammars_[language_], "nothing_to_undo"))};
  }
  if (u.intent == "forget_everything") {
    const DescriptionState before = std::exchange(state_, {});
    if (!before.building.places.empty()) remember(before, u);
    return {};
  }
  return record(u);
}

std::string DescriptionBuilder::ofSpeaker(const std::string& kind) const {
  const SentenceWriter writer(grammars_[language_], false);
  return writer.phrase("owned", {{"owner", speaker_, false, true}, {"kind", kind, false, true}});
}

std::vector<DescriptionIssue> DescriptionBuilder::record(const Utterance& u) {
  const DescriptionState before = state_;
  const DescribedBuilding* before_last =
      history_.empty() ? nullptr : &history_.back().base().building;
  const Listener listener{names_,    grammars_[language_], params_,    speaker_,
                          accepted_, viewpoint_,           before_last};
  state_.context.after_refusal = false;
  Statement statement(u, listener, &state_);
  try {
    statementKind(u.intent)(statement);
    const bool changed = !(state_.building == before.building);
    if (u.correction && !statement.hasCorrected() && changed) {
      // Before anything else was told, or after what was not understood, nothing can be corrected.
      const bool told = !before.building.connections.empty() || !before.building.relations.empty();
      // "No, the kitchen is the second door", of the kitchen: more of what was told right before.
      const auto& subjects = before.context.subjects;
      const bool same_subject = std::any_of(
          state_.context.subjects.begin(), state_.context.subjects.end(),
          [&](Id id) { return std::find(subjects.begin(), subjects.end(), id) != subjects.end(); });
      if (told && !history_.empty() && !before.context.after_refusal && !same_subject) {
        statement.fail(IssueKind::kNoContext, "nothing_corrected");
      }
      statement.report(IssueKind::kNotice, "taken_as_new");
    }
    if (changed) remember(before, u);
  } catch (const Statement::Failed&) {
    // A statement that fails half-way leaves nothing behind, and nothing for "it" to mean.
    state_ = before;
    state_.context.forgetReferences();
  }
  return std::move(statement.issues());
}

void DescriptionBuilder::remember(const DescriptionState& before, const Utterance& said) {
  remember(Recorded{before, said});
}

void DescriptionBuilder::remember(Recorded recorded) {
  if (history_.size() == kLongestHistory) history_.erase(history_.begin());
  history_.push_back(std::move(recorded));
  ++statements_;
}

std::vector<DescriptionIssue> DescriptionBuilder::replaceLast(const Utterance& u) {
  const Grammar& grammar = grammars_[language_];
  const auto refuse = [&](IssueKind kind, const std::string& reason) {
    state_.context.forgetReferences();
    return std::vector<DescriptionIssue>{issueOf(u, kind, reason)};
  };
  const auto name = u.names("name"), instead = u.names("instead");
  if (history_.empty()) {
    return refuse(IssueKind::kNoContext, issueText(grammar, "nothing_to_undo"));
  }
  Utterance again = history_.back().said;
  const std::vector<SaidName*> said = namesIn(&again);
  std::vector<SaidName*> meant;
  for (SaidName* each : said) {
    const bool is = instead.empty() ||
                    compare(names_.key(each->text), names_.key(instead[0].text)) != SameName::kNo;
    if (is) meant.push_back(each);
  }
  // "Sorry, Jack's office" is instead of an office.
  const auto isOther = [&](const SaidName* each) {
    return names_.headOf(each->text) != names_.headOf(name[0].text);
  };
  if (meant.size() > 1 && name.size() == 1) {
    const auto same = std::stable_partition(meant.begin(), meant.end(),
                                            [&](const SaidName* each) { return !isOther(each); });
    if (same - meant.begin() == 1) meant.resize(1);
  }
  if (name.size() != 1 || meant.empty()) {
    const std::string what = instead.empty() ? "" : instead[0].text;
    return refuse(IssueKind::kNoContext, issueText(grammar, "unknown_place", {{"place", what}}));
  }
  if (meant.size() > 1) {
    std::string all;
    for (const SaidName* each : meant) all += (all.empty() ? "'" : ", '") + each->text + "'";
    return refuse(IssueKind::kAsk,
                  issueText(grammar, "replace_what", {{"name", name[0].text}, {"names", all}}));
  }
  *meant.front() = name[0];
  return recordInstead(again, u);
}

std::vector<DescriptionIssue> DescriptionBuilder::replaceNumber(const Utterance& u) {
  const Grammar& grammar = grammars_[language_];
  const auto refuse = [&](const std::string& key) {
    state_.context.forgetReferences();
    return std::vector<DescriptionIssue>{
        issueOf(u, IssueKind::kNoContext, issueText(grammar, key))};
  };
  if (history_.empty() || state_.context.after_refusal) return refuse("nothing_to_undo");
  Utterance again = history_.back().said;
  std::vector<Slot*> numbers;
  for (Slot& slot : again.slots) {
    if (slot.number) numbers.push_back(&slot);
  }
  const Slot* said = u.find("instead");
  if (numbers.size() != 1 || said == nullptr || !said->number) return refuse("which_number");
  // "Six feet, no, seven": not seven metres.
  const double hundredths = *numbers.front()->number * 100.0;
  const bool metric = std::abs(hundredths - std::round(hundredths)) < 1e-6;
  const bool with_unit = u.find("unit") != nullptr;
  if (!metric && !with_unit) return refuse("which_number");
  numbers.front()->number = said->number;
  return recordInstead(again, u);
}

std::vector<DescriptionIssue> DescriptionBuilder::recordInstead(const Utterance& again,
                                                                const Utterance& correction) {
  const Recorded last = history_.back();
  const DescriptionState now = state_;
  undo();
  state_ = last.base();
  std::vector<DescriptionIssue> issues = record(again);
  if (state_.building == last.base().building) {
    state_ = now;
    remember(last);
    state_.context.forgetReferences();
    return issues;
  }
  Recorded instead{now, std::move(history_.back().said), last.base()};
  instead.said.text = correction.text;
  instead.said.range = correction.range;
  history_.pop_back();
  --statements_;
  remember(last);
  remember(std::move(instead));
  return issues;
}

void DescriptionBuilder::acceptName(const std::string& name) {
  accepted_.insert(names_.key(name).full);
}

bool DescriptionBuilder::undo() {
  if (history_.empty()) return false;
  state_ = std::move(history_.back().before);
  history_.pop_back();
  --statements_;
  return true;
}

const Utterance* DescriptionBuilder::lastStatement() const {
  return history_.empty() ? nullptr : &history_.back().said;
}

std::vector<Id> DescriptionBuilder::find(const std::string& name) const {
  return placesOf(name, state_, names_);
}

bool DescriptionBuilder::isCorridorWithoutName(const std::string& name) const {
  return hyselam::utf8Fold(name) == names_.headOf(name) &&
         names_.kindOf(name) == PlaceKind::kCorridor;
}

void DescriptionBuilder::setRobotPlace(const std::string& name, std::optional<PlaceKind> kind) {
  const std::vector<Id> ids = find(name);
  if (ids.size() > 1) {
    throw hyselam::InputError("robot's place", "", "'" + name + "' may mean several places");
  }
  const Id id = ids.empty() ? addPlace(name, names_.kindOf(name), &state_.building) : ids.front();
  DescribedPlace& place = *state_.building.findPlace(id);
  if (!place.kind) place.kind = kind;
  state_.building.robot_place = id;
  state_.context.subjects = {id};
  rememberKind(name, names_, grammars_[language_], &state_.context);
}

void DescriptionBuilder::setViewpoint(const std::optional<hyselam::Pose2>& viewpoint) {
  std::optional<Side>& same = state_.context.side;
  if (same && !lookAlike(viewpoint_, viewpoint)) same.reset();
  viewpoint_ = viewpoint;
}

void DescriptionBuilder::giveName(const std::string& made_up, const std::string& name) {
  const std::vector<Id> from = find(made_up), to = find(name);
  if (from.size() != 1 || to.size() > 1) return;
  DescribedBuilding& building = state_.building;
  if (to.empty() || to == from) {
    DescribedPlace& place = *building.findPlace(from.front());
    place.name = name;
    if (!place.kind) place.kind = names_.kindOf(name);
  } else {
    join(from.front(), to.front(), &state_);
  }
  state_.context.variants.erase(from.front());
}

void DescriptionBuilder::unite(const std::string& name, const std::string& other) {
  DescribedBuilding& building = state_.building;
  // Of these very names: what only may be the same place stays another.
  const auto calledSo = [&](const std::string& wanted) -> Id {
    const std::string key = hyselam::utf8Lower(wanted);
    for (const DescribedPlace& place : building.places) {
      for (const std::string& each : allNamesOf(place)) {
        if (hyselam::utf8Lower(each) == key) return place.id;
      }
    }
    return 0;
  };
  const Id stays = calledSo(name), gone = calledSo(other);
  if (stays == 0 || gone == 0 || stays == gone) return;
  const std::vector<std::string> names = allNamesOf(*building.findPlace(gone));
  join(gone, stays, &state_);
  auto& aliases = building.findPlace(stays)->aliases;
  aliases.insert(aliases.end(), names.begin(), names.end());
  state_.context.variants.erase(gone);
}

Id DescriptionBuilder::called(const std::string& name) const {
  const auto& places = state_.building.places;
  const auto exact = std::find_if(places.begin(), places.end(), [&](const DescribedPlace& place) {
    const std::vector<std::string> all = allNamesOf(place);
    return std::find(all.begin(), all.end(), name) != all.end();
  });
  if (exact != places.end()) return exact->id;
  const std::vector<Id> found = find(name);
  return found.size() == 1 ? found.front() : 0;
}

void DescriptionBuilder::rename(const std::string& old, const std::string& name) {
  const Id id = called(old);
  if (id == 0) return;
  const Id other = called(name);
  if (other != 0 && other != id) {
    join(id, other, &state_);
  } else {
    DescribedPlace& place = *state_.building.findPlace(id);
    place.name = name;
    if (!place.kind) place.kind = names_.kindOf(name);
  }
  state_.context.variants.erase(id);
  for (DescribedPlace& place : state_.building.places) {
    auto& aliases = place.aliases;
    aliases.erase(std::remove_if(aliases.begin(), aliases.end(),
                                 [&](const std::string& alias) {
                                   return alias == old || alias == place.name;
                                 }),
                  aliases.end());
  }
}

bool DescriptionBuilder::forgetName(const std::string& name) {
  const Id id = called(name);
  if (id == 0) return false;
  const auto isSame = [&](const std::string& each) {
    return each == name || compare(names_.key(each), names_.key(name)) != SameName::kNo;
  };
  DescribedPlace& place = *state_.building.findPlace(id);
  auto& aliases = place.aliases;
  aliases.erase(std::remove_if(aliases.begin(), aliases.end(), isSame), aliases.end());
  if (isSame(place.name) && !aliases.empty()) {
    place.name = aliases.front();
    aliases.erase(aliases.begin());
  } else if (isSame(place.name)) {
    removePlace(id, &state_.building);
  }
  state_.context.variants.erase(id);
  state_.context.forgetReferences();
  return true;
}

}  // namespace hyselam_topo

// What is known before and after each change of it, and the way back.
#include <algorithm>
#include <utility>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {
namespace {

/// So many changes can be taken back.
constexpr std::size_t kLongest = 16;

std::vector<std::string> confirmedOf(const std::vector<PlaceTerm>& words) {
  std::vector<std::string> names;
  for (const PlaceTerm& word : words) {
    if (word.confirmed) names.push_back(word.text);
  }
  return names;
}

/// Guesses follow from what is known.
bool sameNames(const PlaceMan::Names& a, const PlaceMan::Names& b) {
  return a.rejected == b.rejected &&
         std::equal(a.words.begin(), a.words.end(), b.words.begin(), b.words.end(),
                    [](const auto& one, const auto& other) {
                      return one.first == other.first &&
                             confirmedOf(one.second) == confirmedOf(other.second);
                    });
}

}  // namespace

Dialogue::Change::Change(Dialogue* dialogue) {
  if (dialogue->talk_.changing) return;
  dialogue_ = dialogue;
  dialogue_->talk_.changing = true;
  const std::size_t statements = dialogue_->builder_.statementCount();
  before_ = {dialogue_->places_.names(), dialogue_->builder_.memory(), statements, statements,
             dialogue_->told_at_};
}

Dialogue::Change::Change(Dialogue* dialogue, KnownBefore before) {
  if (dialogue->talk_.changing) return;
  dialogue_ = dialogue;
  dialogue_->talk_.changing = true;
  before_ = std::move(before);
}

Dialogue::Change::~Change() {
  if (dialogue_ == nullptr) return;
  dialogue_->talk_.changing = false;
  const DescriptionBuilder& builder = dialogue_->builder_;
  const bool told_more = before_.told ? !(before_.told->state.building == builder.building())
                                      : builder.statementCount() > before_.statements;
  if (!told_more && sameNames(before_.names, dialogue_->places_.names())) return;
  dialogue_->remember(std::move(before_));
}

void Dialogue::remember(KnownBefore before) {
  before.after = builder_.statementCount();
  talk_.changes.push_back(std::move(before));
  if (talk_.changes.size() > kLongest) talk_.changes.erase(talk_.changes.begin());
}

void Dialogue::tellNamesAgain(const PlaceMan::Names& since, Reply& out) const {
  const Phrases& p = phrases();
  std::vector<std::string> nameless;
  for (const Place& place : places_.map().places) {
    const auto found = since.words.find(place.id);
    if (found == since.words.end()) continue;
    const std::vector<std::string> names = confirmedOf(place.words);
    if (names == confirmedOf(found->second)) continue;
    const std::string code = codeOf(place);
    if (names.empty()) {
      nameless.push_back(code);
    } else {
      out.sentences.push_back(p.say("names_again", {{"code", code}, {"names", p.list(names)}}));
    }
  }
  if (!nameless.empty()) {
    out.sentences.push_back(p.say("forgot_names", {{"places", p.list(nameless)}}));
  }
}

bool Dialogue::takeBack(Turn& turn) {
  Reply& out = turn.reply;
  const Question::Kind asked = question().kind;
  const bool told_last = asked == Question::Kind::kAlsoName || asked == Question::Kind::kNewName;
  const bool nothing = talk_.changes.empty() && builder_.statementCount() == 0;
  if (told_last || (nothing && question().isAboutName())) {
    talk_.questions.drop();
    say("cancelled", turn);
    return true;
  }
  KnownBefore* last = talk_.changes.empty() ? nullptr : &talk_.changes.back();
  const PlaceMan::Names since = places_.names();
  const std::size_t statements = builder_.statementCount();
  if (last != nullptr && statements <= (last->told ? last->after : last->statements)) {
    if (last->told) builder_.restore(std::move(*last->told));
    told_at_ = last->told_at;
    places_.restoreNames(last->names);
    talk_.changes.pop_back();
    tellNamesAgain(since, out);
    if (out.sentences.empty()) say("taken_back", turn);
  } else {
    const Utterance* said = builder_.lastStatement();
    if (said == nullptr) return false;
    out.sentences.push_back(phrases().say("statement_taken_back", {{"text", said->text}}));
    builder_.undo();
    if (builder_.building().places.empty()) places_.guess({});
    if (last != nullptr && !last->told && builder_.statementCount() <= last->statements) {
      places_.restoreNames(last->names);
      told_at_ = last->told_at;
      talk_.changes.pop_back();
      tellNamesAgain(since, out);
    }
  }
  talk_.questions.drop();
  matchDescription(out, false);
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return true;
}

}  // namespace hyselam_topo

// Names whose place on the map is not sure: where people say that they belong.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

void Dialogue::wonder(std::vector<std::string> names) {
  talk_.wondered = std::move(names);
  talk_.wonders_anew = true;
}

std::optional<Id> Dialogue::placeIn(const Utterance& u) const {
  if (u.intent != "where_answer") return std::nullopt;
  const auto& all = places_.map().places;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Place& place) {
    if (const auto number = u.number("number")) return static_cast<double>(place.id) == *number;
    const std::vector<SaidName> names = u.names("place");
    return names.size() == 1 && names.front().reference.empty() &&
           places_.sameName(codeOf(place), names.front().text);
  });
  return found == all.end() ? std::nullopt : std::optional<Id>(found->id);
}

bool Dialogue::takeWhere(const ParsedText& text, Turn& turn) {
  if (!isWondering()) return false;
  const auto& all = text.utterances;
  const auto answer = std::find_if(all.begin(), all.end(), [&](const Utterance& u) {
    return u.intent != "yes" && u.intent != "no";
  });
  const std::optional<Id> place = answer == all.end() ? std::nullopt : placeIn(*answer);
  if (!place) return false;
  turn.used = static_cast<std::size_t>(answer - all.begin()) + 1;
  turn.answered = true;
  const std::vector<std::string> wondered = std::move(talk_.wondered);
  talk_.wondered.clear();
  const std::vector<std::string> guessed = namesOf(*places_.map().findPlace(*place));
  const auto isGuessedThere = [&](const std::string& name) {
    return std::any_of(guessed.begin(), guessed.end(),
                       [&](const std::string& each) { return places_.sameName(each, name); });
  };
  const auto best = std::find_if(wondered.begin(), wondered.end(), isGuessedThere);
  const std::string name = best == wondered.end() ? wondered.front() : *best;
  const Change change(this);
  if (wondered.size() > 1) {  // which of them is meant was not said
    Question question;
    question.kind = Question::Kind::kConfirmName;
    question.place = *place;
    question.names = {name};
    const std::string sentence = sayFromAfar(question);
    ask(std::move(question), sentence, turn.reply);
  } else if (isNamedOtherwise(*place, {name})) {
    askAlso(*place, {name}, turn.reply);
  } else {
    confirmNames(*place, {name}, turn.reply);
  }
  return true;
}

bool Dialogue::askWondered(Reply& out) {
  if (!isWondering()) return false;
  for (const std::string& name : talk_.wondered) {
    const std::vector<Id> found = places_.find(name);
    if (found.empty()) continue;
    if (nameStateOf(*places_.map().findPlace(found.front())) != NameState::kUnconfirmed) continue;
    askFromAfar(found.front(), out);
    return true;
  }
  askWhere(out);
  return true;
}

bool Dialogue::isOfOtherFloor(const std::string& name) const {
  const std::vector<Id> told = builder_.find(name);
  return std::any_of(told.begin(), told.end(), [&](Id id) {
    return builder_.building().findPlace(id)->floor.value_or(0) != 0;
  });
}

std::map<std::string, std::vector<Id>> Dialogue::whereMayBe() const {
  std::map<std::string, std::vector<Id>> all = talk_.unsure.places;
  std::vector<Id> nameless;
  for (const Place& place : places_.map().places) {
    if (nameStateOf(place) == NameState::kNone) nameless.push_back(place.id);
  }
  for (const DescribedPlace& place : builder_.building().places) {
    const bool missing =
        !isCode(place.name) && places_.find(place.name).empty() && place.floor.value_or(0) == 0;
    if (missing && !nameless.empty()) all.emplace(place.name, nameless);
  }
  return all;
}

void Dialogue::askWhere(Reply& out) {
  const auto& all = places_.map().places;
  const auto nameless = std::find_if(all.begin(), all.end(), [](const Place& place) {
    return nameStateOf(place) != NameState::kConfirmed;
  });
  if (nameless == all.end()) return;
  out.sentences.push_back(phrases().say("ask_where", {{"code", codeOf(*nameless)}}));
}

}  // namespace hyselam_topo

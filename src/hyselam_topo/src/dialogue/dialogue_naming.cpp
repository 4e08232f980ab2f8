// Names of places, told one by one.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_language/building/article.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

bool Dialogue::isNamedOtherwise(Id place, const std::vector<std::string>& names) const {
  const Place& p = *places_.map().findPlace(place);
  if (nameStateOf(p) != NameState::kConfirmed) return false;
  std::vector<std::string> known = namesOf(p);
  const auto isKnown = [&](const std::string& name) {
    return std::any_of(known.begin(), known.end(),
                       [&](const std::string& each) { return places_.sameName(each, name); });
  };
  if (std::any_of(names.begin(), names.end(), isKnown)) return false;
  // Told as another name of it.
  for (const std::string& name : names) {
    for (const Id id : builder_.find(name)) {
      const std::vector<std::string> all = allNamesOf(*builder_.building().findPlace(id));
      if (std::any_of(all.begin(), all.end(), isKnown)) return false;
    }
  }
  return true;
}

std::vector<std::string> Dialogue::withTold(const std::vector<std::string>& names) const {
  std::vector<std::string> all = names;
  for (const std::string& name : names) {
    const std::vector<Id> told = builder_.find(name);
    if (told.size() != 1) continue;
    for (const std::string& other : allNamesOf(*builder_.building().findPlace(told.front()))) {
      const bool known = std::any_of(all.begin(), all.end(), [&](const std::string& each) {
        return places_.sameName(each, other);
      });
      if (!known && !isCode(other)) all.push_back(other);
    }
  }
  return all;
}

std::vector<std::string> Dialogue::ownNames(Id place, const std::vector<std::string>& names) const {
  std::vector<std::string> all = withTold(names);
  // What is known elsewhere stays there.
  all.erase(std::remove_if(all.begin() + static_cast<std::ptrdiff_t>(names.size()), all.end(),
                           [&](const std::string& name) {
                             const std::vector<Id> at = confirmedPlaces(name);
                             return !at.empty() && at != std::vector<Id>{place};
                           }),
            all.end());
  return all;
}

void Dialogue::confirmNames(Id place, const std::vector<std::string>& asked, Reply& out,
                            bool instead) {
  const Phrases& p = phrases();
  const std::vector<std::string> names = ownNames(place, asked);
  const Change change(this);
  const Place& named = *places_.map().findPlace(place);
  std::vector<std::string> old;
  if (instead && nameStateOf(named) == NameState::kConfirmed) old = namesOf(named);
  // Nothing has changed where this throws, and nothing behind it does.
  const std::vector<Id> losers =
      instead ? places_.rename(place, names) : places_.confirm(place, names);
  dropTold(place, old);
  out.sentences.push_back(
      p.say("named", {{"code", codeOf(named)}, {"names", p.list(said(namesOf(named)))}}));
  for (const Id loser : losers) {
    out.sentences.push_back(
        p.say("moved_name", {{"code", codeOf(*places_.map().findPlace(loser))}}));
  }
  if (question().place == place) talk_.questions.drop();
  talk_.subject = place;
  // Sides are told from here.
  giveNames(place);
  for (const std::string& name : namesOf(named)) builder_.unite(namesOf(named).front(), name);
  if (place == robot().place) tellRobotPlace(place, namesOf(named));
  matchDescription(out, false);
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::acceptNames(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    talk_.accepted.insert(names_.key(name).full);
    builder_.acceptName(name);
  }
}

void Dialogue::setSpeaker(const std::string& name, Reply& out) {
  builder_.setSpeaker(name);
  out.sentences.push_back(phrases().say("hello_name", {{"name", name}}));
}

void Dialogue::introduce(const Utterance& u, Turn& turn) {
  const std::vector<SaidName> names = u.names("person");
  if (!names.empty()) setSpeaker(names.front().text, turn.reply);
}

Reply Dialogue::name(Id place, const std::vector<std::string>& names) {
  if (names.empty()) throw hyselam::InputError("name", "", "there is none");
  if (places_.map().findPlace(place) == nullptr) {
    throw hyselam::InputError("places", "id " + std::to_string(place), "there is no such place");
  }
  Reply out = reply();
  std::vector<std::string> bare;  // the robot says them with their article
  for (const std::string& name : names) {
    bare.push_back(knowsLanguage(language_) ? withoutArticle(name, grammar()) : name);
  }
  confirmNames(place, bare, out, true);
  dropStaleQuestion();
  return out;
}

/// Of the map, and of what was told: that a place was called so, or, where it was only guessed to
/// be that place, all of the name, which would be guessed again.
bool Dialogue::forgetNamesOf(Id id) {
  const Place* known = places_.map().findPlace(id);
  if (known == nullptr) return places_.forget(id);
  const std::vector<std::string> old = namesOf(*known);
  const bool guessed = nameStateOf(*known) == NameState::kUnconfirmed;
  const bool had = places_.forget(id);
  if (guessed) {
    for (const std::string& name : old) builder_.forgetName(name);
  } else {
    dropTold(id, old);
  }
  return had;
}

Reply Dialogue::forget(Id place) {
  Reply out = reply();
  const Change change(this);
  forgetNamesOf(place);
  matchDescription(out, false);
  if (question().isAboutName() && question().place == place) talk_.questions.drop();
  dropStaleQuestion();
  out.sentences.push_back(phrases().say("forgot_names", {{"places", codeAndNames(place)}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

void Dialogue::nameThisPlace(const Utterance& u, Turn& turn) {
  if (robot().place == 0) {
    turn.reply.sentences.push_back(phrases().say(places_.hasMap() ? "no_place_here" : "no_map"));
    return;
  }
  Utterance named = u;
  for (Slot& slot : named.slots) {
    if (slot.name == "place") slot.name = "aliases";
  }
  namePlace(robot().place, named, turn);
}

void Dialogue::namePlace(Id place, const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const std::vector<SaidName> said = u.names("aliases");
  const std::vector<std::string> names = textsOf(said);
  if (names.empty()) return;
  if (!std::all_of(said.begin(), said.end(),
                   [&](const SaidName& name) { return isPlaceName(name); })) {
    askNewName(place, names, "", out);
  } else if (isNamedOtherwise(place, names)) {
    askAlso(place, names, out);
  } else {
    confirmNames(place, names, out);
  }
}

void Dialogue::correctName(Id place, const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const bool instead = u.find("was") != nullptr;
  const std::vector<std::string> wrong = textsOf(u.names(instead ? "was" : "aliases"));
  const Change change(this);
  const std::vector<std::string> had = namesOf(*places_.map().findPlace(place));
  places_.reject(place, wrong);
  dropTold(place, had);
  if (question().place == place) talk_.questions.drop();
  if (!instead) {
    out.sentences.push_back(
        phrases().say("not_so", {{"code", codeOf(*places_.map().findPlace(place))},
                                 {"names", phrases().list(said(wrong))}}));
    matchDescription(out, false);
    out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
    return;
  }
  Utterance named = u;
  named.slots = {*u.find("place"), *u.find("aliases")};
  namePlace(place, named, turn);
}

void Dialogue::confirmAll(const Utterance&, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  if (!places_.hasMap()) {
    out.sentences.push_back(p.say("no_map"));
    return;
  }
  const Change change(this);
  std::vector<std::string> confirmed;
  for (const Place& place : std::vector<Place>(places_.map().places)) {
    if (nameStateOf(place) != NameState::kUnconfirmed) continue;
    const std::vector<std::string> names = ownNames(place.id, {namesOf(place).front()});
    places_.confirm(place.id, names);
    giveNames(place.id);
    if (place.id == robot().place) tellRobotPlace(place.id, names);
    confirmed.push_back(said(names.front()));
  }
  if (confirmed.empty()) {
    out.sentences.push_back(p.say("nothing_to_confirm"));
    return;
  }
  talk_.questions.drop();
  matchDescription(out, false);
  out.sentences.push_back(p.say("confirmed_all", {{"places", p.list(confirmed)}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::askForgetEverything(const Utterance&, Turn& turn) {
  Question question;
  question.kind = Question::Kind::kForgetAll;
  ask(std::move(question), phrases().say("ask_forget_all"), turn.reply);
}

void Dialogue::forgetEverything(Reply& out) {
  const Change change(this);
  places_.forgetAllNames();
  // Or the next sentence would bring them back.
  const std::string speaker = builder_.speaker();
  builder_ = DescriptionBuilder(parser_);
  builder_.setLanguage(language_);
  builder_.setSpeaker(speaker);
  talk_.match.reset();
  talk_.unsure = {};
  out.sentences.push_back(phrases().say("forgot_all"));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::forgetNames(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  if (!u.word("all").empty() || u.find("all") != nullptr) {
    askForgetEverything(u, turn);
    return;
  }
  const Change change(this);
  const std::vector<SaidName> said = u.names("place");
  const bool by_name =
      !said.empty() && said.front().reference.empty() && !isCode(said.front().text);
  const bool shelved = by_name && places_.forgetShelved(said.front().text);
  const bool told = by_name && !builder_.find(said.front().text).empty();
  if (told && places_.find(said.front().text).empty()) {  // known from descriptions only
    const bool gone = builder_.forgetName(said.front().text) || shelved;
    matchDescription(out, false);
    const std::string& name = said.front().text;
    out.sentences.push_back(gone ? p.say("forgot_name", {{"name", name}})
                                 : p.say("unknown_place", {{"name", name}}));
    out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
    return;
  }
  if (shelved && confirmedPlaces(said.front().text).empty()) {
    // What was told of it would be guessed on this map otherwise.
    if (told) builder_.forgetName(said.front().text);
    matchDescription(out, false);
    out.sentences.push_back(p.say("forgot_name", {{"name", said.front().text}}));
    out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
    return;
  }
  const std::vector<Id> found = resolve(u, "place", out);
  if (found.empty()) return;
  std::vector<std::string> codes;
  bool had = false;
  for (const Id id : found) {
    codes.push_back(codeOf(*places_.map().findPlace(id)));
    if (by_name) continue;
    had = forgetNamesOf(id) || had;
  }
  if (by_name) {
    const std::string& name = said.front().text;
    const auto confirmed = confirmedPlaces(name);
    had = !places_.forgetName(name).empty();
    for (const Id id : confirmed) dropTold(id, {name});
    if (confirmed.empty() && had) builder_.forgetName(name);
  }
  matchDescription(out, false);
  if (question().kind == Question::Kind::kConfirmName) talk_.questions.drop();
  out.sentences.push_back(p.say(had ? "forgot_names" : "no_names", {{"places", p.list(codes)}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::rename(const Utterance& u, Turn& turn) {
  const auto names = textsOf(u.names("name"));
  if (names.empty()) return;
  const std::vector<SaidName> old = u.names("place");
  const bool by_name = !old.empty() && old.front().reference.empty();
  if (by_name && places_.find(old.front().text).empty() &&
      builder_.find(old.front().text).empty()) {  // whom it was told of before may use either
    Utterance both = u;
    both.kind = UtteranceKind::kStatement;
    both.intent = "alias";
    for (Slot& slot : both.slots) {
      if (slot.name == "name") slot.name = "aliases";
    }
    addStatement(both, turn);
    return;
  }
  const Change change(this);
  if (by_name && !isCode(old.front().text) && confirmedPlaces(old.front().text).empty() &&
      builder_.find(old.front().text).size() == 1) {  // known from descriptions only
    const DescribedBuilding before = builder_.building();
    builder_.rename(before.findPlace(builder_.find(old.front().text).front())->name, names.front());
    readBack(before, false, turn.reply);
    matchDescription(turn.reply, true);
    turn.reply.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
    return;
  }
  const std::vector<Id> found = resolve(u, "place", turn.reply);
  for (const Id id : found) {
    const Place& place = *places_.map().findPlace(id);
    std::vector<std::string> gone;
    if (nameStateOf(place) == NameState::kConfirmed) gone = namesOf(place);
    confirmNames(id, {names.front()}, turn.reply, true);
    gone.erase(std::remove_if(
                   gone.begin(), gone.end(),
                   [&](const std::string& name) { return places_.sameName(name, names.front()); }),
               gone.end());
    if (gone.empty()) continue;
    turn.reply.sentences.push_back(
        phrases().say("not_so_any_more", {{"names", phrases().list(gone)}}));
  }
}

void Dialogue::dropTold(Id id, const std::vector<std::string>& names) {
  const Place& place = *places_.map().findPlace(id);
  const bool has_others = nameStateOf(place) == NameState::kConfirmed;
  const std::vector<std::string> others = namesOf(place);
  for (const std::string& name : names) {
    if (std::find(others.begin(), others.end(), name) != others.end()) continue;
    // Rooms may be cut into several places with one name.
    const std::vector<Id> same = confirmedPlaces(name);
    if (std::any_of(same.begin(), same.end(), [&](Id each) { return each != id; })) continue;
    builder_.rename(name, has_others ? others.front() : codeOf(place));
  }
}

}  // namespace hyselam_topo

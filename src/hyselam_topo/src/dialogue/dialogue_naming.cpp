// Names of places, told one by one.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
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

void Dialogue::confirmNames(Id place, const std::vector<std::string>& names, Reply& out) {
  const Phrases& p = phrases();
  std::map<Id, std::vector<PlaceTerm>> words;
  for (const Place& each : places_.map().places) words[each.id] = each.words;
  BeforeNaming before{place, std::move(words), builder_};
  // Nothing has changed where this throws, and nothing behind it does.
  const std::vector<Id> losers = places_.confirm(place, names);
  talk_.named_now.emplace(std::move(before));
  const Place& named = *places_.map().findPlace(place);
  out.sentences.push_back(
      p.say("named", {{"code", codeOf(named)}, {"names", p.list(namesOf(named))}}));
  for (const Id loser : losers) {
    out.sentences.push_back(
        p.say("moved_name", {{"code", codeOf(*places_.map().findPlace(loser))}}));
  }
  if (question().place == place) talk_.questions.drop();
  talk_.subject = place;
  // Sides are told from here.
  giveNames(place);
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
  confirmNames(place, names, out);
  dropStaleQuestion();
  return out;
}

Reply Dialogue::forget(Id place) {
  Reply out = reply();
  places_.forget(place);
  if (question().isAboutName() && question().place == place) talk_.questions.drop();
  dropStaleQuestion();
  out.sentences.push_back(phrases().say("forgot_names", {{"places", label(place)}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

void Dialogue::nameThisPlace(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  if (robot().place == 0) {
    out.sentences.push_back(phrases().say(places_.hasMap() ? "no_place_here" : "no_map"));
    return;
  }
  std::vector<std::string> names = textsOf(u.names("place"));
  const auto aliases = textsOf(u.names("aliases"));
  names.insert(names.end(), aliases.begin(), aliases.end());
  const Id place = robot().place;
  if (names.empty()) return;
  const std::vector<SaidName> said = u.names("place");
  if (!std::all_of(said.begin(), said.end(),
                   [&](const SaidName& name) { return isPlaceName(name); })) {
    askNewName(place, names, "", out);
  } else if (isNamedOtherwise(place, names)) {
    askAlso(place, names, out);
  } else {
    confirmNames(place, names, out);
  }
}

bool Dialogue::takeNameBack(Turn& turn) {
  if (talk_.questions.isOpen() && question().isAboutName()) {
    talk_.questions.drop();
    say("cancelled", turn);
    return true;
  }
  std::optional<BeforeNaming>& before = talk_.named_now ? talk_.named_now : talk_.named_last;
  if (!before || talk_.described_last) return false;
  for (const auto& [id, words] : before->words) {
    if (places_.map().findPlace(id) != nullptr) places_.setWords(id, words);
  }
  builder_ = std::move(before->builder);
  const std::string code = codeOf(*places_.map().findPlace(before->place));
  before.reset();
  turn.reply.sentences.push_back(phrases().say("forgot_names", {{"places", code}}));
  turn.reply.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return true;
}

void Dialogue::askForgetEverything(const Utterance&, Turn& turn) {
  Question question;
  question.kind = Question::Kind::kForgetAll;
  ask(std::move(question), phrases().say("ask_forget_all"), turn.reply);
}

void Dialogue::forgetEverything(Reply& out) {
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
  const std::vector<SaidName> said = u.names("place");
  const std::vector<Id> found = resolve(u, "place", out);
  if (found.empty()) return;
  std::vector<std::string> codes;
  bool had = false;
  const bool by_name = !said.empty() && said.front().reference.empty();
  for (const Id id : found) {
    codes.push_back(codeOf(*places_.map().findPlace(id)));
    if (!by_name) had = places_.forget(id) || had;
  }
  if (by_name) had = !places_.forgetName(said.front().text).empty();
  if (question().kind == Question::Kind::kConfirmName) talk_.questions.drop();
  out.sentences.push_back(p.say(had ? "forgot_names" : "no_names", {{"places", p.list(codes)}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::rename(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const std::vector<Id> found = resolve(u, "place", out);
  const auto names = textsOf(u.names("name"));
  if (found.empty() || names.empty()) return;
  for (const Id id : found) {
    const Place& place = *places_.map().findPlace(id);
    // What was told of it under the name that goes is told of it under the new one; not what was
    // told of a place that is only guessed to be this one.
    if (nameStateOf(place) == NameState::kConfirmed) {
      for (const std::string& old : namesOf(place)) builder_.giveName(old, names.front());
    }
    places_.forget(id);
    confirmNames(id, {names.front()}, out);
  }
}

}  // namespace hyselam_topo

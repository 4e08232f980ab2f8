// From what people call a place to the places that are meant, and back to what the robot calls
// them.
#include <algorithm>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_language/building/article.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "told_facts.hpp"

namespace hyselam_topo {

const Grammar& Dialogue::grammar() const {
  return parser_.grammar(knowsLanguage(language_) ? language_
                                                  : parser_.grammars().front().language());
}

std::vector<Id> Dialogue::resolve(const SaidName& name, Reply& out) {
  std::vector<Id> found;
  if (name.reference == "here") {
    if (robot().place != 0) found.push_back(robot().place);
    if (found.empty()) out.sentences.push_back(phrases().say("no_place_here"));
  } else if (name.reference == "it") {
    if (talk_.subject != 0 && places_.map().findPlace(talk_.subject) != nullptr)
      found.push_back(talk_.subject);
    if (found.empty()) {
      out.sentences.push_back(phrases().say("unknown_place", {{"name", "'" + name.text + "'"}}));
      out.unknown_name = true;
    }
  } else {
    found = places_.find(name.text);
    // "The garage", which was told to be another name of the workshop.
    for (const std::string& other : withTold({name.text})) {
      if (found.empty()) found = places_.find(other);
    }
    // A guess is no place for a name that people gave to another one.
    if (places_.isShelved(name.text) && confirmedPlaces(name.text).empty()) found.clear();
    if (found.empty() && tellOnlyTold(name.text, out)) return {};
    if (areOfOtherNames(name.text, found)) {
      out.sentences.push_back(
          phrases().say("which_place", {{"places", phrases().list(labels(found))}}));
      return {};
    }
    if (found.empty()) {
      out.sentences.push_back(phrases().say("unknown_place", {{"name", name.text}}));
      out.unknown_name = true;
    }
  }
  if (!found.empty()) talk_.subject = found.front();
  return found;
}

std::vector<Id> Dialogue::resolve(const Utterance& u, const std::string& slot, Reply& out) {
  const std::vector<SaidName> names = u.names(slot);
  if (names.empty()) {
    SaidName here;
    here.reference = "here";
    return resolve(here, out);
  }
  return resolve(names.front(), out);
}

bool Dialogue::areOfOtherNames(const std::string& name, const std::vector<Id>& places) const {
  if (places.size() < 2) return false;
  const NameKey said = names_.key(name);
  std::set<std::string> others;
  for (const Id id : places) {
    for (const std::string& each : namesOf(*places_.map().findPlace(id))) {
      const NameKey key = names_.key(each);
      if (key.full == said.full) return false;
      if (!key.kind.empty() && key.kind == said.kind) others.insert(key.full);
    }
  }
  return others.size() > 1;
}

bool Dialogue::tellOnlyTold(const std::string& name, Reply& out) {
  if (places_.isShelved(name)) {
    out.sentences.push_back(phrases().say("not_on_this_map", {{"name", said(name)}}));
    return true;
  }
  const std::vector<Id> told = builder_.find(name);
  if (told.empty()) return false;
  out.sentences.push_back(phrases().say("told_only", {{"name", said(name)}}));
  std::string facts;
  for (const std::string& fact : factsOf(builder_.building(), told.front(), grammar())) {
    facts += (facts.empty() ? "" : " ") + fact;
  }
  if (!facts.empty()) out.sentences.push_back(phrases().say("told", {{"text", facts}}));
  if (places_.hasMap() && !isOfOtherFloor(name)) {
    askWhere(out);
    wonder({builder_.building().findPlace(told.front())->name});
  }
  return true;
}

std::vector<Id> Dialogue::described(const SaidName& name) const {
  if (name.reference.empty()) return builder_.find(name.text);
  const Id place = name.reference == "here" ? robot().place : talk_.subject;
  const Place* known = places_.map().findPlace(place);
  std::vector<Id> found;
  if (known == nullptr) return found;
  for (const std::string& each : namesOf(*known)) {
    for (const Id id : builder_.find(each)) {
      if (std::find(found.begin(), found.end(), id) == found.end()) found.push_back(id);
    }
  }
  return found;
}

std::vector<Id> Dialogue::confirmedPlaces(const std::string& name) const {
  std::vector<Id> found = places_.find(name);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [&](Id id) {
                               return nameStateOf(*places_.map().findPlace(id)) !=
                                      NameState::kConfirmed;
                             }),
              found.end());
  return found;
}

std::vector<Id> Dialogue::placesOfKind(const std::string& name) const {
  const std::string head = names_.headOf(names_.singular(name));
  std::vector<Id> found;
  for (const Place& place : places_.map().places) {
    const bool is = std::any_of(place.words.begin(), place.words.end(), [&](const PlaceTerm& word) {
      return places_.sameName(word.text, name) ||
             (!head.empty() && names_.headOf(word.text) == head);
    });
    if (is) found.push_back(place.id);
  }
  return found;
}

// ---- In sentences of the robot ----

std::string Dialogue::codeAndNames(Id id) const {
  const Place& place = *places_.map().findPlace(id);
  const std::string names = phrases().list(namesOf(place));
  switch (nameStateOf(place)) {
    case NameState::kNone:
      return codeOf(place);
    case NameState::kUnconfirmed:
      return codeOf(place) + ", " + phrases().say("perhaps", {{"name", names}});
    case NameState::kConfirmed:
      break;
  }
  return codeOf(place) + ", " + names;
}

std::string Dialogue::shortName(Id id) const {
  const Place& place = *places_.map().findPlace(id);
  return place.words.empty() ? codeOf(place) : namesOf(place).front();
}

std::vector<std::string> Dialogue::labels(const std::vector<Id>& ids) const {
  std::vector<std::string> all;
  for (const Id id : ids) {
    const Place& place = *places_.map().findPlace(id);
    const std::string code = codeOf(place);
    const NameState state = nameStateOf(place);
    if (state == NameState::kNone) {
      all.push_back(code);
      continue;
    }
    std::string label = said(shortName(id));
    if (state == NameState::kUnconfirmed) label = phrases().say("perhaps", {{"name", label}});
    all.push_back(label.append(" (").append(code).append(")"));
  }
  return all;
}

std::string Dialogue::said(const std::string& name) const {
  return knowsLanguage(language_) ? withArticle(name, grammar()) : name;
}

std::string Dialogue::subject(const std::string& name) const {
  bool plural = false;
  const std::string text = knowsLanguage(language_) ? withArticle(name, grammar(), &plural) : name;
  return text == name || plural ? name : capital(text);
}

std::vector<std::string> Dialogue::said(std::vector<std::string> names) const {
  for (std::string& name : names) name = said(name);
  return names;
}

}  // namespace hyselam_topo

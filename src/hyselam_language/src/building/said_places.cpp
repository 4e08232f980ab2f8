#include "said_places.hpp"

#include <algorithm>
#include <cstring>

#include "edit_description.hpp"
#include "fact_sentences.hpp"
#include "grammar/compiled_grammar.hpp"
#include "grammar/word_lists.hpp"
#include "hyselam_common/utf8.hpp"
#include "issue_texts.hpp"
#include "name_words.hpp"

namespace hyselam_topo {
namespace {

/// More places of one name than anybody counts.
constexpr double kMostOfOneName = 100.0;

/// "'room 110', 'lab 110'", or how they lie if they are of one name.
std::string listed(Statement& s, const std::vector<Id>& ids) {
  std::string all;
  for (const Id id : ids) all += (all.empty() ? "'" : ", '") + s.nameOf(id) + "'";
  return all;
}

bool haveOneName(Statement& s, const std::vector<Id>& ids) {
  const PlaceNames& names = s.listener().names;
  return std::all_of(ids.begin(), ids.end(), [&](Id id) {
    return compare(names.key(s.nameOf(id)), names.key(s.nameOf(ids.front()))) == SameName::kYes;
  });
}

[[noreturn]] void failSeveral(Statement& s, const SaidName& name, const std::vector<Id>& ids) {
  if (haveOneName(s, ids)) {
    s.fail(IssueKind::kAsk, "which", {{"name", name.text}, {"names", choices(s, ids)}});
  }
  s.fail(IssueKind::kAmbiguous, "may_mean", {{"name", name.text}, {"names", listed(s, ids)}});
}

/// Of several places told as a row, the last one: what comes "then" comes behind it; 0: no row.
Id lastOfRow(Statement& s) {
  const std::vector<Id>& all = s.context().subjects;
  const DescribedBuilding& building = s.building();
  const auto comesAfter = [&](Id place, Id last) {
    const auto& relations = building.relations;
    return std::any_of(relations.begin(), relations.end(), [&](const DescribedRelation& each) {
      return !each.denied && each.kind == RelationKind::kAfter && each.a == place && each.b == last;
    });
  };
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (comesAfter(all[i], all[i - 1])) continue;
    const DescribedConnection* last = nullptr;
    const DescribedConnection* here = nullptr;
    for (const DescribedConnection& each : building.connections) {
      if (each.side == Side::kUnknown) continue;
      if (each.to == all[i - 1]) last = &each;
      if (each.to == all[i]) here = &each;
    }
    const bool in_row = last != nullptr && here != nullptr && last->from == here->from &&
                        last->side == here->side && last->order < here->order;
    if (!in_row) return 0;
  }
  return all.size() > 1 ? all.back() : 0;
}

/// "Anna's office", "gabinete da Ana": not "sala de estar".
bool tellsOwner(const std::string& name) {
  for (const char* sign :
       {"' ", "'s ", "\xe2\x80\x99 ", "\xe2\x80\x99s ", " do ", " da ", " dos ", " das "}) {
    if (name.find(sign) != std::string::npos) return true;
  }
  return false;
}

/// What a word that stands for places means; fails if that was not told.
std::vector<Id> referred(Statement& s, const SaidName& name, const std::string& slot = "") {
  const DescriptionContext& context = s.context();
  const auto nothing = [&] {
    // A subject that was left out ("fica à direita") has no word to point at.
    if (name.range.begin == name.range.end) s.fail(IssueKind::kNoContext, "it_unsaid");
    s.fail(IssueKind::kNoContext, "it_nothing", {{"name", name.text}});
  };
  if (name.reference == "here") {
    if (!s.building().robot_place) s.fail(IssueKind::kNoContext, "no_robot");
    return {*s.building().robot_place};
  }
  if (name.reference == "self") s.fail(IssueKind::kMeaningless, "itself", {{"place", name.text}});
  if (name.reference == "two") {
    const auto& all = context.subjects.size() > 1 ? context.subjects : context.group;
    const auto& two = all.size() == 2 ? all : context.pair;
    if (two.size() != 2) nothing();
    return two;
  }
  if (name.reference == "they") {
    const auto& all = context.subjects.size() > 1 ? context.subjects : context.group;
    const auto& they = all.empty() ? context.subjects : all;
    if (they.empty()) nothing();
    return they;
  }
  if (name.reference == "it") {
    if (context.subjects.empty()) nothing();
    // "Then the lab": behind a room, not behind the corridor where the robot is.
    const bool unsaid = name.range.begin == name.range.end;
    const Id front = context.subjects.front();
    if (slot == "after" && unsaid && front == s.building().robot_place &&
        s.at(front).kind == PlaceKind::kCorridor) {
      nothing();
    }
    if (context.subjects.size() > 1) {
      const Id last = slot == "after" ? lastOfRow(s) : 0;
      if (last != 0) return {last};
      s.fail(IssueKind::kAmbiguous, "it_several",
             {{"name", name.text}, {"names", listed(s, context.subjects)}});
    }
    return context.subjects;
  }
  // "Across from her": from the room of the person named last.
  if (name.reference == "whose") {
    const auto& all = context.subjects;
    if (all.size() != 1 || !tellsOwner(s.at(all.front()).name)) nothing();
    return all;
  }
  if (context.group.empty()) nothing();
  if (name.reference == "first") return {context.group.front()};
  if (name.reference == "last") return {context.group.back()};
  std::vector<Id> left;
  for (const Id id : context.group) {
    if (context.told_of_group.count(id) == 0) left.push_back(id);
  }
  // "One is ...": of those not spoken of any is as good.
  if (name.reference == "one" && !left.empty()) return {left.front()};
  if (name.reference == "other" && left.size() == 1) return left;
  s.fail(IssueKind::kNoContext, "it_what", {{"name", name.text}});
}

/// The words of a name that are the folded ones: "vestiário" for "vestiario".
std::string asSaid(const std::string& name, const std::string& folded) {
  const std::vector<std::string> words = language::splitWords(name);
  const std::vector<std::string> wanted = language::splitWords(folded);
  for (std::size_t begin = 0; begin + wanted.size() <= words.size(); ++begin) {
    std::string run;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      run += (k > 0 ? " " : "") + words[begin + k];
    }
    if (hyselam::utf8Fold(run) == folded) return run;
  }
  return folded;
}

/// A name as it was said, with "one".
std::string saidText(const Statement& s, const SaidName& name) {
  const Utterance& u = s.said();
  const bool within = name.range.begin >= u.range.begin && name.range.end > name.range.begin &&
                      name.range.end - u.range.begin <= u.text.size();
  return within ? u.text.substr(name.range.begin - u.range.begin, name.range.end - name.range.begin)
                : name.text;
}

/// "The men's", "the ladies'": a noun of places by itself.
bool isPlaceNoun(const Statement& s, const std::string& name) {
  const auto* type = s.listener().grammar.compiled().nameType("place");
  if (type == nullptr) return false;
  const std::string folded = hyselam::utf8Fold(name);
  const std::string bare = folded.substr(0, folded.find_first_of("'\xe2"));
  const bool plural = folded.size() > bare.size() && !bare.empty() && bare.back() == 's';
  return type->nouns.count(folded) != 0 || (plural && type->nouns.count(bare) != 0);
}

/// "The women's" after "the men's changing room": of that kind; not after "Paul's office".
bool isOfPair(Statement& s, const std::string& kind) {
  const std::string end = " " + kind;
  const auto& places = s.building().places;
  return std::any_of(places.begin(), places.end(), [&](const DescribedPlace& place) {
    const std::string& name = place.name;
    return name.size() > end.size() &&
           name.compare(name.size() - end.size(), end.size(), end) == 0 &&
           isPlaceNoun(s, name.substr(0, name.size() - end.size()));
  });
}

/// The one known place that is somebody's: "curator's office" for "the curator's"; "" without one.
std::string knownOf(Statement& s, const SaidName& name) {
  const auto* type = s.listener().grammar.compiled().nameType("place");
  if (type == nullptr || name.speaker || type->head_first) return "";
  if (name.text.find('\'') == std::string::npos &&
      name.text.find("\xe2\x80\x99") == std::string::npos)
    return "";
  const std::string owner = hyselam::utf8Fold(name.text) + " ";
  std::string found;
  for (const DescribedPlace& place : s.building().places) {
    for (const std::string& each : allNamesOf(place)) {
      if (hyselam::utf8Fold(each).compare(0, owner.size(), owner) != 0) continue;
      if (!found.empty()) return "";
      found = each;
    }
  }
  return found;
}

/// "John's" after "the waiting room" is no waiting room of his: what people have is an office.
bool isOwnedKind(const Statement& s, const std::string& kind) {
  const auto* type = s.listener().grammar.compiled().nameType("place");
  return type != nullptr && type->titles.count(hyselam::utf8Fold(kind)) != 0;
}

/// What "the chemistry one", "Mary's" and "the big one" leave out.
std::string kindLeftOut(Statement& s, const SaidName& name) {
  const DescriptionContext& context = s.context();
  const auto* type = s.listener().grammar.compiled().nameType("place");
  const bool owned = name.speaker || name.text.find('\'') != std::string::npos ||
                     name.text.find("\xe2\x80\x99") != std::string::npos;
  const bool pair = owned && isPlaceNoun(s, name.text);
  if (pair && (context.owned_kind.empty() || !isOfPair(s, context.owned_kind))) return "";
  if (owned && !context.owned_kind.empty()) return context.owned_kind;
  // "You are in the corridor. The last door is Joe's": nobody's corridor.
  if (owned && s.listener().names.kindOf(context.kind_word) == PlaceKind::kCorridor) {
    // "The chapel's ower there": of no person, so that is asked.
    const std::string owner = name.text.substr(0, name.text.find_first_of("'\xe2"));
    const bool is_place = isPlaceNoun(s, name.text) || !s.listener().names.headOf(owner).empty();
    return is_place ? "" : s.listener().grammar.say("office");
  }
  const std::string& kind =
      owned || context.described_kind.empty() ? context.kind_word : context.described_kind;
  if (owned && !isOwnedKind(s, kind)) return "";
  const bool adjective =
      type != nullptr && type->elliptic_adjectives.count(hyselam::utf8Fold(name.text)) != 0;
  if (owned || adjective || type == nullptr || type->head_first) return kind;
  // "The chemistry one" after "the physics lab", which is a kind of its own.
  const std::string last = kind.substr(kind.rfind(' ') + 1);
  return s.listener().names.headOf(last).empty() ? kind : last;
}

/// "The meeting rooms", where two are known and none is called so; otherwise nothing.
std::vector<Id> severalOf(Statement& s, const SaidName& name) {
  const PlaceNames& names = s.listener().names;
  const std::string full = fullName(s, name), one = names.singular(full);
  if (one == full || !placesOf(full, s.state(), names).empty()) return {};
  const std::vector<Id> ids = placesOf(one, s.state(), names);
  return ids.size() > 1 ? ids : std::vector<Id>{};
}

}  // namespace

void rememberKind(const std::string& full, const PlaceNames& names, const Grammar& grammar,
                  DescriptionContext* context) {
  const std::string folded = names.headOf(full);
  if (folded.empty()) return;
  const std::string head = asSaid(full, folded);
  context->kind_word = head;
  if (tellsOwner(full)) context->owned_kind = head;
  const std::size_t space = full.rfind(' ');
  if (hasDigit(full) || space == std::string::npos) return;
  context->described_kind = head;
  // "Sala de reuniões grande": the adjective comes last.
  const auto* type = grammar.compiled().nameType("place");
  const bool adjective =
      type != nullptr && type->head_first &&
      type->elliptic_adjectives.count(hyselam::utf8Fold(full.substr(space + 1))) != 0;
  if (adjective) context->described_kind = full.substr(0, space);
}

std::vector<Id> placesOf(const std::string& name, const DescriptionState& state,
                         const PlaceNames& names) {
  std::vector<std::vector<std::string>> all;
  for (const DescribedPlace& place : state.building.places) {
    all.push_back(allNamesOf(place));
    const auto variants = state.context.variants.find(place.id);
    if (variants == state.context.variants.end()) continue;
    all.back().insert(all.back().end(), variants->second.begin(), variants->second.end());
  }
  std::vector<Id> ids;
  for (const std::size_t i : names.find(name, all)) ids.push_back(state.building.places[i].id);
  if (!ids.empty() || !state.building.robot_place) return ids;
  // "You are in the main corridor. ... the corridor": the one where the robot is, also if nobody
  // has named it, or the name tells no kind.
  const DescribedPlace* here = state.building.findPlace(*state.building.robot_place);
  const bool bare = hyselam::utf8Fold(name) == names.headOf(name);
  const bool nameless = here != nullptr && here->kind == PlaceKind::kCorridor &&
                        !names.kindOf(here->name).has_value();
  if (bare && here != nullptr && names.kindOf(name) == PlaceKind::kCorridor &&
      (nameless || names.headOf(here->name) == names.headOf(name))) {
    ids.push_back(here->id);
  }
  return ids;
}

std::string choices(Statement& s, const std::vector<Id>& ids) {
  const Grammar& grammar = s.listener().grammar;
  const SentenceWriter writer(grammar, false);
  std::string all;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i > 0) all += i + 1 == ids.size() ? issueText(grammar, "or") : ", ";
    const auto& connections = s.building().connections;
    const auto lies = std::find_if(connections.begin(), connections.end(), [&](const auto& each) {
      return each.to == ids[i] && each.side != Side::kUnknown;
    });
    const std::string key =
        lies == connections.end() ? "" : std::string("where_") + toString(lies->side);
    if (!key.empty() && grammar.has(key)) {
      all += writer.phrase(key, {writer.place("place", s.building(), lies->from)});
    } else {
      all += issueText(grammar, "number_of", {{"count", std::to_string(i + 1)}});
    }
  }
  return all;
}

std::string fullName(Statement& s, const SaidName& name) {
  const Grammar& grammar = s.listener().grammar;
  const SentenceWriter writer(grammar, false);
  if (name.speaker) {
    // "My own office" is my office.
    std::string said = name.text;
    for (const char* own : {"own ", "pr\xc3\xb3prio ", "pr\xc3\xb3pria "}) {
      if (said.compare(0, std::strlen(own), own) == 0) said.erase(0, std::strlen(own));
    }
    const std::string& speaker = s.listener().speaker;
    // "My kitchen" of a cook: there is one, whoever speaks; "my office" is one of many.
    const PlaceNames& names = s.listener().names;
    const std::string head = name.elliptic ? "" : names.headOf(said);
    const auto* type = grammar.compiled().nameType("place");
    const bool only_one = type != nullptr && !head.empty() && type->nouns.count(head) != 0 &&
                          type->titles.count(head) == 0 && !names.isPlainRoom(said) &&
                          head == hyselam::utf8Fold(said);
    if (speaker.empty() && only_one) return said;
    if (speaker.empty()) s.fail(IssueKind::kAsk, "whose", {{"name", name.text}});
    std::string kind = said;
    if (name.elliptic) kind = kindLeftOut(s, name);
    if (kind.empty()) kind = grammar.say("office");
    return writer.phrase("owned", {{"owner", speaker, false, true}, {"kind", kind, false, true}});
  }
  if (!name.elliptic) return name.text;
  if (const std::string known = knownOf(s, name); !known.empty()) return known;
  const std::string kind = kindLeftOut(s, name);
  const auto full = [&](const std::string& word) {
    return writer.phrase("elliptic",
                         {{"owner", name.text, false, true}, {"kind", word, false, true}});
  };
  if (kind.empty() && isPlaceNoun(s, name.text)) return name.text;  // "the men's"
  if (kind.empty()) {
    s.fail(IssueKind::kAsk, "what_of",
           {{"name", saidText(s, name)}, {"example", full(grammar.say("office"))}});
  }
  return full(kind);
}

void checkName(Statement& s, const SaidName& name, const std::string& full) {
  const Listener& listener = s.listener();
  if (!listener.params.ask_strange_names || name.quoted || name.speaker || name.elliptic) return;
  if (!s.said().word("named").empty()) return;
  if (listener.names.isOfPlace(full)) return;
  if (listener.accepted.count(listener.names.key(full).full) != 0) return;
  s.report(IssueKind::kStrangeName, "strange", {{"name", full}});
  s.issues().back().name = full;
  throw Statement::Failed();
}

Id placeOf(Statement& s, const SaidName& name) {
  if (!name.reference.empty()) {
    const std::vector<Id> ids = referred(s, name);
    if (ids.size() != 1) s.fail(IssueKind::kMeaningless, "one_place");
    return ids.front();
  }
  const std::string full = fullName(s, name);
  const std::vector<Id> ids = placesOf(full, s.state(), s.listener().names);
  if (ids.size() > 1) failSeveral(s, name, ids);
  rememberKind(full, s.listener().names, s.listener().grammar, &s.context());
  if (ids.empty()) {
    checkName(s, name, full);
    return addPlace(full, s.listener().names.kindOf(full), &s.building());
  }
  if (s.nameOf(ids.front()) != full) {
    auto& variants = s.context().variants[ids.front()];
    if (std::find(variants.begin(), variants.end(), full) == variants.end()) {
      variants.push_back(full);
    }
  }
  return ids.front();
}

Id placeOf(Statement& s, const std::string& slot) {
  const std::vector<Id> ids = placesOf(s, slot);
  if (ids.size() != 1) s.fail(IssueKind::kMeaningless, "one_place");
  return ids.front();
}

std::vector<Id> placesOf(Statement& s, const std::string& slot) {
  std::vector<Id> all;
  for (const SaidName& name : s.said().names(slot)) {
    // "The fire exit, that's at the end": the one just named.
    if (name.reference == "it" && all.size() == 1) continue;
    std::vector<Id> ids = name.reference.empty() ? severalOf(s, name) : referred(s, name, slot);
    if (ids.empty()) ids = {placeOf(s, name)};
    for (const Id id : ids) {
      if (std::find(all.begin(), all.end(), id) == all.end()) all.push_back(id);
    }
  }
  return all;
}

std::vector<Id> knownPlacesOf(Statement& s, const std::string& slot) {
  for (const SaidName& name : s.said().names(slot)) {
    if (!name.reference.empty()) continue;
    if (placesOf(fullName(s, name), s.state(), s.listener().names).empty()) {
      s.fail(IssueKind::kNoContext, "unknown_place", {{"place", name.text}});
    }
  }
  return placesOf(s, slot);
}

std::vector<Id> placesOfOneName(Statement& s, const SaidName& name, double count) {
  const PlaceNames& names = s.listener().names;
  const std::string full = names.singular(fullName(s, name));
  std::vector<Id> ids = placesOf(full, s.state(), names);
  if (!(count >= 1.0) || count > kMostOfOneName) {
    s.fail(IssueKind::kMeaningless, "out_of_range", {{"value", shown(count)}});
  }
  if (static_cast<double>(ids.size()) > count) {
    s.fail(IssueKind::kContradiction, "other_count",
           {{"known", std::to_string(ids.size())}, {"count", shown(count)}});
  }
  if (ids.empty()) checkName(s, name, full);
  rememberKind(full, names, s.listener().grammar, &s.context());
  while (static_cast<double>(ids.size()) < count) {
    ids.push_back(addPlace(full, names.kindOf(full), &s.building()));
  }
  return ids;
}

std::vector<Id> countedPlaces(Statement& s) {
  const std::string slot = s.said().find("places") != nullptr ? "places" : "place";
  const auto count = s.said().number("count");
  const auto names = s.said().names(slot);
  const bool several = count && *count > 1.0 && names.size() == 1 && names[0].reference.empty();
  if (several) {
    const std::string full = fullName(s, names[0]);
    if (s.listener().names.singular(full) != full) return placesOfOneName(s, names[0], *count);
  }
  std::vector<Id> ids = placesOf(s, slot);
  if (count && static_cast<std::size_t>(*count) != ids.size()) {
    s.fail(IssueKind::kMeaningless, "count",
           {{"count", shown(*count)}, {"named", std::to_string(ids.size())}});
  }
  return ids;
}

std::vector<Id> placesBetween(Statement& s) {
  const auto said = s.said().names("between");
  if (said.size() == 1 && said[0].reference.empty()) {
    const PlaceNames& names = s.listener().names;
    const std::string full = names.singular(fullName(s, said[0]));
    std::vector<Id> ids = placesOf(full, s.state(), names);
    if (full != said[0].text && ids.empty()) return placesOfOneName(s, said[0], 2.0);
    if (ids.size() == 2) return ids;
  }
  const std::vector<Id> ids = placesOf(s, "between");
  if (ids.size() != 2) s.fail(IssueKind::kAsk, "between_what");
  return ids;
}

}  // namespace hyselam_topo

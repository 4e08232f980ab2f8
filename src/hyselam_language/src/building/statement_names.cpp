// What places are called: names and aliases, owners, "the next one is".
#include <algorithm>
#include <iterator>

#include "hyselam_common/utf8.hpp"
#include "record_facts.hpp"
#include "said_places.hpp"
#include "sentence_writer.hpp"
#include "statement_kinds.hpp"

namespace hyselam_topo {
namespace statements {
namespace {

std::vector<Id> knownAs(Statement& s, const SaidName& name) {
  if (!name.reference.empty()) return {};
  return placesOf(fullName(s, name), s.state(), s.listener().names);
}

/// "No, it is Jack's office": instead of the one alias, or the one told last.
void replaceAlias(Statement& s, Id id) {
  std::vector<std::string>& aliases = s.at(id).aliases;
  const DescribedBuilding* before = s.listener().before_last;
  const DescribedPlace* then = before == nullptr ? nullptr : before->findPlace(id);
  std::vector<std::string> last;
  std::copy_if(aliases.begin(), aliases.end(), std::back_inserter(last), [&](const auto& each) {
    return then == nullptr ||
           std::find(then->aliases.begin(), then->aliases.end(), each) == then->aliases.end();
  });
  if (last.empty() && aliases.size() == 1) last = aliases;
  if (last.size() != 1) return;
  aliases.erase(std::find(aliases.begin(), aliases.end(), last.front()));
  s.setCorrected();
}

/// "It used to be John's office": no place has that further name any more.
void forgetNames(Statement& s, const std::vector<SaidName>& was) {
  const PlaceNames& names = s.listener().names;
  for (const SaidName& name : was) {
    const NameKey key = names.key(fullName(s, name));
    for (DescribedPlace& place : s.building().places) {
      const auto isMeant = [&](const std::string& each) {
        return compare(names.key(each), key) == SameName::kYes;
      };
      const auto gone = std::remove_if(place.aliases.begin(), place.aliases.end(), isMeant);
      if (gone != place.aliases.end()) s.setCorrected();
      place.aliases.erase(gone, place.aliases.end());
    }
  }
}

/// Two names of one place, of which the first may be told as one of the second: "The fish tank is
/// also called C12", where only C12 is known.
void takeBothNames(Statement& s, const SaidName& said, const std::vector<SaidName>& aliases) {
  const std::vector<Id> known = aliases.size() == 1 ? knownAs(s, aliases[0]) : std::vector<Id>{};
  if (known.size() == 1 && said.reference.empty() && knownAs(s, said).empty()) {
    s.at(known.front()).aliases.push_back(fullName(s, said));
    return s.setSubjects(known);
  }
  const Id id = placeOf(s, said);
  if (s.isCorrection()) replaceAlias(s, id);
  for (const SaidName& name : aliases) addAlias(s, id, name);
  s.setSubjects({id});
}

/// The word before a name in what was said: its article.
std::string wordBefore(const Statement& s, const SaidName& name) {
  const Utterance& u = s.said();
  if (name.range.begin <= u.range.begin) return "";
  const std::string before = u.text.substr(0, name.range.begin - u.range.begin);
  const std::size_t last = before.find_last_not_of(' ');
  if (last == std::string::npos) return "";
  const std::size_t space = before.rfind(' ', last);
  const std::size_t begin = space == std::string::npos ? 0 : space + 1;
  return hyselam::utf8Lower(before.substr(begin, last + 1 - begin));
}

/// "Ana's office", "gabinete da Ana": as the owner was spoken of.
std::string ownedBy(const Statement& s, const SaidName& owner, const std::string& kind) {
  const Grammar& grammar = s.listener().grammar;
  // "The nurses sit here": the nurses' office.
  const bool plural = owner.text.size() > 1 && owner.text.back() == 's' && owner.text[0] >= 'a' &&
                      owner.text[0] <= 'z' && grammar.has("owned_plural");
  const std::string with_article = plural ? "owned_plural" : "owned_" + wordBefore(s, owner);
  return SentenceWriter(grammar, false)
      .phrase(grammar.has(with_article) ? with_article : "owned",
              {{"owner", owner.text, false, true}, {"kind", kind, false, true}});
}

/// The places of those who were named with a room that has no other name.
std::vector<SaidName> ownedPlaces(Statement& s, const std::string& kind,
                                  const std::string& owners = "owners") {
  const Grammar& grammar = s.listener().grammar;
  std::vector<SaidName> all = s.said().names(owners);
  for (SaidName& each : all) each.text = ownedBy(s, each, kind);
  for (const SaidName& each : s.said().names(owners == "owners" ? "owned" : "")) {
    all.push_back(each);
    all.back().text =
        SentenceWriter(grammar, false)
            .phrase("elliptic", {{"owner", each.text, false, true}, {"kind", kind, false, true}});
  }
  for (SaidName& each : all) {
    each.elliptic = false;
    each.reference.clear();
  }
  return all;
}

/// "Room 3 is not John's office."
void notAlias(Statement& s) {
  const Id id = knownPlacesOf(s, "place").front();
  auto& aliases = s.at(id).aliases;
  const PlaceNames& names = s.listener().names;
  const std::size_t before = aliases.size();
  for (const SaidName& name : s.said().names("aliases")) {
    const NameKey key = names.key(fullName(s, name));
    const auto isMeant = [&](const std::string& each) {
      return compare(names.key(each), key) == SameName::kYes;
    };
    aliases.erase(std::remove_if(aliases.begin(), aliases.end(), isMeant), aliases.end());
  }
  if (aliases.size() == before) s.fail(IssueKind::kNoContext, "not_told");
  s.setCorrected();
  s.setSubjects({id});
}

/// "The next one is the lab": behind the place that the last statement was about, in its row.
void nextIs(Statement& s) {
  if (s.context().subjects.empty()) {
    s.fail(IssueKind::kNoContext, "it_nothing", {{"name", s.said().names("place")[0].text}});
  }
  const Id last = s.context().subjects.back();
  const Id id = placeOf(s, "aliases");
  const Id robot = s.building().robot_place.value_or(0);
  recordNext(s, id, last, robot == id || robot == last ? 0 : robot);
  s.setSubjects({id});
}

}  // namespace

void addAlias(Statement& s, Id id, const SaidName& name) {
  if (!name.reference.empty()) s.fail(IssueKind::kMeaningless, "no_name", {{"name", name.text}});
  const std::string full = fullName(s, name);
  const std::vector<Id> ids = placesOf(full, s.state(), s.listener().names);
  if (std::find(ids.begin(), ids.end(), id) != ids.end()) return;
  if (!ids.empty()) {
    s.fail(IssueKind::kContradiction, "other_place", {{"name", full}, {"place", s.nameOf(id)}});
  }
  s.at(id).aliases.push_back(full);
  if (!s.at(id).kind) s.at(id).kind = s.listener().names.kindOf(full);
}

void alias(Statement& s) {
  // "Canteen, dining hall, it's the same."
  const auto both = s.said().names("both");
  if (both.size() == 2) return takeBothNames(s, both[0], {both[1]});
  const auto said = s.said().names("place");
  if (said.size() != 1) s.fail(IssueKind::kMeaningless, "one_place");
  if (said[0].reference == "next") return nextIs(s);
  if (s.isDenial()) return notAlias(s);
  forgetNames(s, s.said().names("was"));
  takeBothNames(s, said[0], s.said().names("aliases"));
}

/// "The room that was Tom's is Ann's now": one place, with another name.
void newOwner(Statement& s, const std::string& kind) {
  const SaidName old = ownedPlaces(s, kind, "former").front();
  const SaidName now = ownedPlaces(s, kind).front();
  const auto ids = placesOf(old.text, s.state(), s.listener().names);
  if (ids.size() != 1 || !placesOf(now.text, s.state(), s.listener().names).empty()) {
    return s.setSubjects({placeOf(s, now)});
  }
  DescribedPlace& place = s.at(ids.front());
  const PlaceNames& names = s.listener().names;
  const auto isOld = [&](const std::string& each) {
    return compare(names.key(each), names.key(old.text)) == SameName::kYes;
  };
  if (isOld(place.name)) {
    place.name = now.text;
  } else {
    std::replace_if(place.aliases.begin(), place.aliases.end(), isOld, now.text);
  }
  s.context().variants.erase(place.id);
  s.setCorrected();
  s.setSubjects(ids);
}

void owner(Statement& s) {
  if (s.isDenial()) refuseDenial(s);
  const std::string room = s.said().word("room_kind");
  if (!room.empty() && s.said().find("former") != nullptr) return newOwner(s, room);
  const auto said = s.said().names("place");
  if (said.size() != 1) s.fail(IssueKind::kMeaningless, "one_place");
  const Grammar& grammar = s.listener().grammar;
  const PlaceNames& names = s.listener().names;
  // "Tom's lab" of a lab, "Tom's office" of a room.
  const std::string name =
      said[0].reference.empty() ? fullName(s, said[0]) : s.nameOf(placeOf(s, said[0]));
  // "This lab belongs to her": where nothing has a name yet, too.
  const std::string pointed = said[0].reference.empty() ? "" : names.headOf(said[0].text);
  std::string kind = names.isPlainRoom(name) ? pointed : names.headOf(name);
  if (kind.empty() || names.isPlainRoom(kind)) kind = grammar.say("office");
  // "Room 5 was Tom's, now it is Ann's."
  forgetNames(s, ownedPlaces(s, kind, "former"));
  std::vector<SaidName> owned = ownedPlaces(s, kind);
  if (owned.empty() || !s.said().word("speaker_too").empty()) {  // "I work in room 5"
    if (s.listener().speaker.empty()) s.fail(IssueKind::kAsk, "whose", {{"name", kind}});
    SaidName mine;
    mine.text = kind;
    mine.speaker = true;
    owned.insert(owned.begin(), mine);
  }
  takeBothNames(s, said[0], owned);
}

/// "Joe has the room next to the lab", "The office next to the lab is Joe's."
void ownerLocated(Statement& s) {
  const std::string kind = s.said().word("room_kind");
  const std::vector<SaidName> names =
      ownedPlaces(s, kind.empty() ? s.listener().grammar.say("office") : kind);
  if (names.empty()) s.fail(IssueKind::kMeaningless, "one_place");
  Utterance where = s.said();
  Slot places;
  places.name = "places";
  places.type = "place";
  places.range = names.front().range;
  places.names = {names.front()};
  where.slots.push_back(places);
  s.recordAs(located, where);
  const Id id = placeOf(s, names.front());
  for (std::size_t i = 1; i < names.size(); ++i) addAlias(s, id, names[i]);
}

}  // namespace statements
}  // namespace hyselam_topo

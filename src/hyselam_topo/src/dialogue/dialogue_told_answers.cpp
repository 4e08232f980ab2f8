// Answers from what was told, then from the map.
#include <algorithm>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_language/building/describe_building.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "neighbors.hpp"
#include "told_facts.hpp"

namespace hyselam_topo {
namespace {

double areaOf(const AugmentedTopologicalMap& map, const std::vector<Id>& places) {
  double area = 0.0;
  for (const Id id : places) area += map.findPlace(id)->area;
  return area;
}

}  // namespace

void Dialogue::answerTold(const Utterance&, Turn& turn) {
  const Phrases& p = phrases();
  if (builder_.building().places.empty()) {
    turn.reply.sentences.push_back(p.say("told_nothing"));
    return;
  }
  turn.reply.sentences.push_back(
      p.say("told", {{"text", describeBuilding(builder_.building(), grammar())}}));
}

void Dialogue::answerWhatIsKnown(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const std::vector<SaidName> names = u.names("place");
  if (names.empty()) return;
  std::string text;
  for (const Id id : described(names.front())) {
    for (const std::string& fact : factsOf(builder_.building(), id, grammar())) {
      text += (text.empty() ? "" : " ") + fact;
    }
  }
  if (!text.empty()) {
    out.sentences.push_back(p.say("told", {{"text", text}}));
  } else {
    const std::vector<Id> found = resolve(names.front(), out);
    if (!found.empty()) {
      out.sentences.push_back(p.say("known_place", {{"places", p.list(labels(found))}}));
    }
  }
}

void Dialogue::answerOwner(const Utterance& u, Turn& turn) {
  const Phrases& p = phrases();
  const std::vector<SaidName> said = u.names("place");
  std::vector<std::string> owners;
  std::string place;
  if (!said.empty()) {
    place = said.front().text;
    for (const Id id : described(said.front())) {
      const DescribedPlace& found = *builder_.building().findPlace(id);
      const auto each = ownersOf(found);
      owners.insert(owners.end(), each.begin(), each.end());
      if (!said.front().reference.empty()) place = found.name;
    }
  }
  if (owners.empty()) {
    turn.reply.sentences.push_back(p.say("owner_unknown", {{"place", place}}));
  } else {
    turn.reply.sentences.push_back(p.say("owners", {{"names", p.list(owners)}}));
  }
}

void Dialogue::answerPersonPlace(const Utterance& u, Turn& turn) {
  const std::vector<SaidName> said = u.names("person");
  if (said.empty()) return;
  const std::string person = names_.key(said.front().text).full;
  for (const std::string& name : knownNames()) {
    if (names_.key(name).full.find(person) == std::string::npos) continue;
    Utterance where = u;
    where.slots.front().name = "place";
    where.slots.front().names = {said.front()};
    where.slots.front().names.front().text = name;
    answerWhereIs(where, turn);
    return;
  }
  turn.reply.unknown_name = true;  // of a thing: another node may know it
  turn.reply.sentences.push_back(phrases().say("person_unknown", {{"name", said.front().text}}));
}

void Dialogue::sayTruth(const std::optional<bool>& truth, const std::string& reason, Reply& out) {
  const Phrases& p = phrases();
  if (!truth) {
    out.sentences.push_back(p.say("not_known"));
  } else if (*truth) {
    out.sentences.push_back(p.say("yes"));
  } else {
    out.sentences.push_back(reason.empty() ? p.say("no") : p.say("no_since", {{"reason", reason}}));
  }
}

void Dialogue::answerIsLocated(const Utterance& u, Turn& turn) {
  const Truth told = truthOf(builder_, asStatement(u, "located"));
  std::optional<bool> truth = told.told;
  // What has a door to the other is next to it; without one, who knows.
  const std::vector<SaidName> places = u.names("places"), other = u.names("next_to");
  if (!truth && places.size() == 1 && other.size() == 1 && u.slots.size() == 2 &&
      areJoined(places_.map(), confirmedPlaces(places[0].text), confirmedPlaces(other[0].text))) {
    truth = true;
  }
  sayTruth(truth, told.reason, turn.reply);
}

void Dialogue::answerIsJoined(const Utterance& u, Turn& turn) {
  const Truth told = truthOf(builder_, asStatement(u, "joined"));
  std::optional<bool> truth = told.told;
  const std::vector<SaidName> a = u.names("a"), b = u.names("b");
  if (!truth && !a.empty() && !b.empty()) {
    const auto at_a = confirmedPlaces(a[0].text), at_b = confirmedPlaces(b[0].text);
    if (!at_a.empty() && !at_b.empty()) truth = areJoined(places_.map(), at_a, at_b);
  }
  sayTruth(truth, told.reason, turn.reply);
}

void Dialogue::answerIsLarger(const Utterance& u, Turn& turn) {
  const Truth told = truthOf(builder_, asStatement(u, "larger"));
  std::optional<bool> truth = told.told;
  const std::vector<SaidName> a = u.names("a"), b = u.names("b");
  if (!truth && !a.empty() && !b.empty()) {
    const double area_a = areaOf(places_.map(), confirmedPlaces(a[0].text));
    const double area_b = areaOf(places_.map(), confirmedPlaces(b[0].text));
    if (area_a > 0.0 && area_b > 0.0) truth = area_a > area_b;
  }
  sayTruth(truth, told.reason, turn.reply);
}

void Dialogue::answerWhatIsLocated(const Utterance& u, Turn& turn) {
  const Phrases& p = phrases();
  const std::vector<std::string> found = placesWhere(builder_, u);
  turn.reply.sentences.push_back(
      found.empty() ? p.say("not_known") : p.say("found_there", {{"places", p.list(said(found))}}));
}

void Dialogue::answerIsKnown(const Utterance& u, Turn& turn) {
  const Phrases& p = phrases();
  const std::vector<SaidName> said = u.names("place");
  if (said.empty()) return;
  const std::vector<Id> found = placesOfKind(said.front().text);
  if (!found.empty()) {
    turn.reply.sentences.push_back(p.say("known_place", {{"places", p.list(labels(found))}}));
  } else if (!tellOnlyTold(said.front().text, turn.reply)) {
    turn.reply.sentences.push_back(p.say("unknown_place", {{"name", said.front().text}}));
    turn.reply.unknown_name = true;
  }
}

void Dialogue::answerNearest(const Utterance& u, Turn& turn) {
  const std::vector<SaidName> said = u.names("place");
  if (said.empty()) return;
  const std::vector<Id> found = placesOfKind(said.front().text);
  if (found.empty()) {
    turn.reply.sentences.push_back(phrases().say("unknown_place", {{"name", said.front().text}}));
    turn.reply.unknown_name = true;
    return;
  }
  const auto leg = robot().has_pose ? route(robot().pose, found) : std::optional<RouteLeg>();
  const Id nearest = leg ? leg->places.back() : found.front();
  Utterance where = u;
  where.slots.front().name = "place";
  where.slots.front().names = {said.front()};
  where.slots.front().names.front().text = codeOf(*places_.map().findPlace(nearest));
  answerWhereIs(where, turn);
}

void Dialogue::answerHowMany(const Utterance& u, Turn& turn) {
  const Phrases& p = phrases();
  const std::vector<SaidName> said = u.names("place");
  if (said.empty()) {
    answerWhichPlaces(u, turn);
    return;
  }
  const std::string head = names_.headOf(names_.singular(said.front().text));
  std::set<std::string> names;
  for (const std::string& name : knownNames()) {
    if (!head.empty() && names_.headOf(name) == head) names.insert(name);
  }
  turn.reply.sentences.push_back(
      names.empty() ? p.say("unknown_place", {{"name", said.front().text}})
                    : p.say("how_many", {{"count", std::to_string(names.size())},
                                         {"names", p.list({names.begin(), names.end()})}}));
}

void Dialogue::answerLargest(const Utterance& u, Turn& turn) {
  const Phrases& p = phrases();
  const bool large = u.word("size_word") != "small";
  const Place* best = nullptr;
  for (const Place& place : places_.map().places) {
    if (place.words.empty() || !(place.area > 0.0)) continue;
    if (best == nullptr || (large ? place.area > best->area : place.area < best->area)) {
      best = &place;
    }
  }
  turn.reply.sentences.push_back(
      best == nullptr ? p.say("not_known")
                      : p.say("size", {{"place", capital(labels({best->id}).front())},
                                       {"area", p.number(best->area, 1)}}));
}

void Dialogue::answerWhoAmI(const Utterance&, Turn& turn) {
  const std::string& speaker = builder_.speaker();
  turn.reply.sentences.push_back(speaker.empty() ? phrases().say("speaker_unknown")
                                                 : phrases().say("speaker", {{"name", speaker}}));
}

}  // namespace hyselam_topo

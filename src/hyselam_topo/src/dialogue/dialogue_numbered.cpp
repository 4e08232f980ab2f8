// "The third room on the right", "the last door on the left": which place is meant, where it stands
// for a name in statements, orders and questions, and in what others are told.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_language/grammar/numbered_names.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "match_constraints.hpp"
#include "match_report.hpp"

namespace hyselam_topo {
namespace {

constexpr Id kHere = 1, kNumberedPlace = 2;  // of the description of what is asked for

bool hasNumbered(const Utterance& u) {
  return std::any_of(u.slots.begin(), u.slots.end(), [](const Slot& slot) {
    return std::any_of(slot.names.begin(), slot.names.end(),
                       [](const SaidName& name) { return name.reference == kNumbered; });
  });
}

}  // namespace

bool Dialogue::isWhereTold() const {
  const DescribedBuilding& building = builder_.building();
  const Place* here = places_.map().findPlace(robot().place);
  if (here == nullptr || !robot().has_pose || robot().in_doorway) return false;
  if (!building.robot_place) return true;
  const DescribedPlace& told = *building.findPlace(*building.robot_place);
  const std::vector<Id> found = places_.find(told.name);
  if (!found.empty()) return std::find(found.begin(), found.end(), here->id) != found.end();
  return here->kind == PlaceKind::kCorridor && told.kind == PlaceKind::kCorridor;
}

Dialogue::AtNumber<Id> Dialogue::placesAtNumber(Side side, int number) const {
  if (!isWhereTold()) return {};
  const Place& here = *places_.map().findPlace(robot().place);
  // As if it were told that some place is there: the map answers both alike.
  DescribedBuilding asked;
  asked.places.resize(2);
  asked.places[0].id = kHere;
  asked.places[0].name = codeOf(here);
  asked.places[1].id = kNumberedPlace;
  asked.places[1].name = "?";
  DescribedConnection there;
  there.from = kHere;
  there.to = kNumberedPlace;
  there.side = side;
  there.rank = number;
  there.seen_from = robot().pose;
  asked.connections.push_back(there);
  asked.robot_place = kHere;
  MatchObserver observer;
  observer.heading = robot().pose.theta;
  observer.position = hyselam::Point2{robot().pose.x, robot().pose.y};
  MatchConstraints constraints;
  constraints.confirmed.emplace_back(here.id, kHere);
  try {
    MatchProblem problem = compileMatch(asked, places_.map(), observer, constraints);
    problem.attributes[1].needs_place = true;
    const PlaceAssignment match = solveExact(problem, params_.match);
    if (!match.found()) return {};
    const Uncertainty unsure = uncertaintyOf(match, problem, params_.match, asked);
    AtNumber<Id> found;
    for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
      if (nameAt(match.best(), v) == 1) found.all.push_back(problem.vertices[v]);
    }
    const auto places = unsure.places.find(asked.places[1].name);
    if (places != unsure.places.end()) found.all = places->second;
    const auto likely = unsure.likely.find(asked.places[1].name);
    found.is_first =
        found.all.size() == 1 || (likely != unsure.likely.end() && !found.all.empty() &&
                                  likely->second == found.all.front());
    return found;
  } catch (const hyselam::InputError&) {
    return {};  // a map that nothing can be matched with
  }
}

Dialogue::AtNumber<std::string> Dialogue::namesOfNumbered(const SaidName& place) const {
  const auto side = sideOf(place.side);
  if (!side) return {};
  // What was told to be there, as it is seen from here.
  const DescribedBuilding& building = builder_.building();
  const auto view = robot().has_pose ? std::optional(robot().pose) : std::nullopt;
  for (const DescribedConnection& each : building.connections) {
    const bool told = building.robot_place == each.from && each.side == *side &&
                      each.rank == place.number && areSameView(each.seen_from, view);
    if (told) return {{building.findPlace(each.to)->name}, true};
  }
  const AtNumber<Id> found = placesAtNumber(*side, place.number);
  AtNumber<std::string> names{{}, found.is_first};
  for (const Id id : found.all) {
    const Place& known = *places_.map().findPlace(id);
    names.all.push_back(nameStateOf(known) == NameState::kConfirmed ? namesOf(known).front()
                                                                    : codeOf(known));
  }
  return names;
}

std::string Dialogue::sayNumberedUnknown(const SaidName& place,
                                         const std::vector<std::string>& perhaps) const {
  const Phrases& p = phrases();
  if (perhaps.empty()) return p.say("numbered_unknown", {{"text", place.text}});
  return p.say("numbered_unsure", {{"text", place.text}, {"places", p.list(said(perhaps))}});
}

std::optional<Utterance> Dialogue::withNumberedNamed(const Utterance& heard, Turn& turn) {
  constexpr std::size_t kMostProposals = 3;
  Utterance u = heard;
  followRobot(true);
  for (Slot& slot : u.slots) {
    for (SaidName& name : slot.names) {
      if (name.reference != kNumbered) continue;
      const std::vector<std::string> meant = namesOfNumbered(name).all;
      if (meant.size() != 1) {
        const std::string reason = sayNumberedUnknown(name, meant);
        turn.reply.refusals.push_back({u.text, reason, false, ""});
        const TextRange range{name.range.begin - u.range.begin, name.range.end - u.range.begin};
        const bool few = !meant.empty() && meant.size() <= kMostProposals;
        if (few && turn.proposals.empty() && range.end <= u.text.size()) {
          for (const std::string& each : meant) {
            turn.proposals.push_back(withNameFor(u.text, range, each, !isCode(each), grammar()));
          }
          turn.refusal_of_proposal = reason;
        } else {
          turn.not_understood.push_back(reason);
        }
        return std::nullopt;
      }
      turn.reply.sentences.push_back(sayNumbered(name.text, meant));
      name.text = meant.front();
      name.reference.clear();
      name.side.clear();
      name.number = 0;
    }
  }
  return u;
}

std::string Dialogue::sayNumbered(const std::string& said_as,
                                  const std::vector<std::string>& meant) const {
  const char* const key = meant.size() == 1 ? "numbered" : "numbered_likely";
  return phrases().say(key, {{"text", said_as}, {"place", said(meant.front())}});
}

bool Dialogue::handleNumbered(const Utterance& u, Turn& turn) {
  if (!hasNumbered(u)) return false;
  if (const auto named = withNumberedNamed(u, turn)) {
    handleUtterance(*named, turn);
    return true;
  }
  builder_.sentenceRefused();
  turn.lost = turn.about_else = true;
  return true;
}

void Dialogue::nameNumberedForOthers(Turn& turn) {
  std::vector<ForwardedSentence> known;
  for (ForwardedSentence& sentence : turn.reply.forwarded) {
    sentence.for_others = sentence.text;
    const std::vector<SaidName> all = numberedNamesIn(sentence.text, grammar());
    std::string unsure;
    for (auto name = all.rbegin(); name != all.rend(); ++name) {
      const AtNumber<std::string> meant = namesOfNumbered(*name);
      if (!meant.is_first && !meant.all.empty()) unsure = sayNumberedUnknown(*name, meant.all);
      if (!meant.is_first) continue;
      sentence.for_others = withNameFor(sentence.for_others, name->range, meant.all.front(),
                                        !isCode(meant.all.front()), grammar());
      sentence.numbered.insert(sentence.numbered.begin(), sayNumbered(name->text, meant.all));
    }
    if (unsure.empty()) {
      known.push_back(std::move(sentence));
    } else {  // they would take it for less
      turn.reply.refusals.push_back({sentence.text, unsure, false, ""});
      turn.not_understood.push_back(unsure);
    }
  }
  turn.reply.forwarded = std::move(known);
}

void Dialogue::giveNumberedName(const Utterance& u) {
  const auto side = sideOf(u.word("side"));
  const auto number = hyselam::parseNumber(u.word("nth"));
  const Slot* places = u.find("places") != nullptr ? u.find("places") : u.find("place");
  const bool one = places != nullptr && places->names.size() == 1 &&
                   places->names.front().reference.empty() && u.word("denied").empty() &&
                   u.find("nth_b") == nullptr;
  const auto& all = builder_.building().places;
  const bool by_code =
      std::any_of(all.begin(), all.end(), [&](const auto& each) { return isCode(each.name); });
  if (!side || !number || !one || !by_code) return;
  const std::vector<Id> told = builder_.find(places->names.front().text);
  if (told.size() != 1) return;
  const AtNumber<Id> found = placesAtNumber(*side, static_cast<int>(*number));
  if (!found.is_first) return;
  const std::string code = codeOf(*places_.map().findPlace(found.all.front()));
  if (builder_.find(code).size() != 1) return;
  builder_.giveName(code, builder_.building().findPlace(told.front())->name);
}

}  // namespace hyselam_topo

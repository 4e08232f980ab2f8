// Descriptions of the building: recorded, matched with the map, the result reported.
#include <algorithm>
#include <iterator>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/building/describe_change.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "match_constraints.hpp"
#include "match_report.hpp"

namespace hyselam_topo {
namespace {

/// "my office"
bool saysMy(const Utterance& u) {
  return std::any_of(u.slots.begin(), u.slots.end(), [](const Slot& slot) {
    return std::any_of(slot.names.begin(), slot.names.end(),
                       [](const SaidName& name) { return name.speaker; });
  });
}

/// The words before what is the speaker's: "my".
std::vector<std::string> wordsForMine(const Utterance& u) {
  std::vector<std::string> words;
  for (const Slot& slot : u.slots) {
    for (const SaidName& name : slot.names) {
      if (!name.speaker || name.elliptic || name.range.begin < u.range.begin + 2) continue;
      const std::size_t end = name.range.begin - u.range.begin;
      if (end > u.text.size() || u.text[end - 1] != ' ') continue;
      const std::size_t space = u.text.rfind(' ', end - 2);
      const std::size_t begin = space == std::string::npos ? 0 : space + 1;
      words.push_back(u.text.substr(begin, end - 1 - begin));
    }
  }
  return words;
}

/// "On your left", "the second door", "here": means something only where the robot is.
bool isSeenFromRobot(const Utterance& u) {
  return std::any_of(u.slots.begin(), u.slots.end(), [](const Slot& slot) {
    static const std::set<std::string> kSeen{"side", "nth", "distance", "steps"};
    return kSeen.count(slot.name) != 0 ||
           std::any_of(slot.names.begin(), slot.names.end(),
                       [](const SaidName& name) { return name.reference == "here"; });
  });
}

}  // namespace

void Dialogue::addStatement(const Utterance& u, Turn& turn) {
  if (!turn.before) turn.known_before = knownNow();
  // Where the robot has gone is nothing that is told.
  if (u.intent != "robot_in") followRobot(isSeenFromRobot(u) || saysItsCorridor(u));
  if (!turn.before) turn.before = builder_.building();
  const std::vector<SaidName> place = u.names("place");
  if (u.intent == "robot_in" && !std::all_of(place.begin(), place.end(), [&](const auto& name) {
        return !name.reference.empty() || isPlaceName(name);
      })) {
    // All that follows is told from there.
    attempt(turn.reply, [&] { recordStatements(turn); });
    askNewName(robot().place, textsOf(place), turn.text.substr(u.range.begin), turn.reply);
    turn.broken_off = true;
    return;
  }
  if (u.intent == "robot_in" && askPose(u, turn)) return;
  const DescribedBuilding known = builder_.building();
  const std::size_t statements = builder_.statementCount();
  auto issues = builder_.add(u);
  const auto denied = deniedByMap(known);
  if (denied && builder_.statementCount() > statements && builder_.undo()) {
    issues.push_back({IssueKind::kContradiction, *denied, u.text, u.range, ""});
  }
  // "... Undo that." behind a statement may go further back.
  turn.known_before.statements = std::min(turn.known_before.statements, builder_.statementCount());
  turn.issues.insert(turn.issues.end(), issues.begin(), issues.end());
  turn.described = true;
  if (u.intent == "robot_in" && !u.word("denied").empty()) {
    // "This is not the library": whatever it is, it is not called so.
    if (places_.map().findPlace(robot().place) != nullptr) {
      places_.reject(robot().place, textsOf(place));
    }
    turn.beyond_here = turn.told = true;
    return;
  }
  if (u.intent == "robot_in") {
    told_at_ = robot().place;
    // Described from several places in thought, the first one is where the robot is.
    if (turn.here.empty()) {
      turn.here = textsOf(place);
      const auto aliases = textsOf(u.names("aliases"));
      turn.here.insert(turn.here.end(), aliases.begin(), aliases.end());
    }
    return;
  }
  turn.beyond_here = true;
  turn.told = true;
  if (issues.empty() && builder_.speaker().empty()) {
    // "My cabin" is taken for the cabin, of which there is one: whose it is is not known. Nobody
    // misses whose it is in "our kitchen".
    const std::string of_one =
        grammar().has("of_one_speaker") ? " " + grammar().say("of_one_speaker") + " " : "";
    for (const std::string& my : wordsForMine(u)) {
      if (of_one.find(" " + hyselam::utf8Fold(my) + " ") == std::string::npos) continue;
      turn.left_out.push_back(my);
    }
  }
  turn.asks_speaker = turn.asks_speaker || (builder_.speaker().empty() && saysMy(u));
  if (!u.word("side").empty()) turn.sides = true;
  if (u.intent == "forget_place") {
    for (const std::string& name : textsOf(place)) {
      places_.forgetName(name);
      places_.forgetShelved(name);
    }
  }
}

bool Dialogue::isCode(const std::string& name) const {
  const auto& all = places_.map().places;
  return std::any_of(all.begin(), all.end(),
                     [&](const Place& place) { return places_.sameName(codeOf(place), name); });
}

bool Dialogue::saysItsCorridor(const Utterance& u) const {
  const Place* here = places_.map().findPlace(robot().place);
  if (here == nullptr || here->kind != PlaceKind::kCorridor) return false;
  return std::any_of(u.slots.begin(), u.slots.end(), [&](const Slot& slot) {
    return std::any_of(slot.names.begin(), slot.names.end(), [&](const SaidName& name) {
      return name.reference.empty() && builder_.isCorridorWithoutName(name.text) &&
             builder_.find(name.text).empty();
    });
  });
}

void Dialogue::followRobot(bool also_unnamed) {
  const bool can_look = robot().has_pose && !robot().in_doorway;
  builder_.setViewpoint(robot().has_pose ? std::optional(robot().pose) : std::nullopt);
  const Place* here = places_.map().findPlace(robot().place);
  if (here == nullptr || !can_look) return;
  // Told where it is and not moved since, it may be led about in thought.
  const bool told = builder_.building().robot_place.has_value();
  if (told && (told_at_ == 0 || told_at_ == here->id)) return;
  std::vector<std::string> names;
  if (nameStateOf(*here) == NameState::kConfirmed) names = namesOf(*here);
  if (names.empty() && also_unnamed) names.push_back(codeOf(*here));
  const bool corridor = here->kind == PlaceKind::kCorridor;
  tellRobotPlace(here->id, std::move(names),
                 corridor ? std::optional(PlaceKind::kCorridor) : std::nullopt);
}

void Dialogue::tellRobotPlace(Id place, std::vector<std::string> names,
                              std::optional<PlaceKind> kind) {
  // One that was told of, best; else the first.
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::string& name) { return builder_.find(name).size() == 1; });
  const auto fits = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return builder_.find(name).size() < 2;
  });
  if (fits == names.end()) return;
  builder_.setRobotPlace(*fits, kind);
  told_at_ = place;
}

void Dialogue::giveNames(Id place) {
  const Place& named = *places_.map().findPlace(place);
  builder_.giveName(codeOf(named), namesOf(named).front());
}

void Dialogue::readBack(const DescribedBuilding& before, bool here_told, Reply& out) {
  const Phrases& p = phrases();
  const DescribedBuilding& after = builder_.building();
  DescribedBuilding known = before;
  // Where the robot is is told by itself, and the map's own name for it is nothing that was told.
  const DescribedPlace* at = after.robot_place ? after.findPlace(*after.robot_place) : nullptr;
  if (at != nullptr && (here_told || isCode(at->name))) {
    known.robot_place = after.robot_place;
    if (known.findPlace(at->id) == nullptr) known.places.push_back(*at);
    std::sort(known.places.begin(), known.places.end(),
              [](const DescribedPlace& a, const DescribedPlace& b) { return a.id < b.id; });
  }
  if (known == after) return;
  std::string told;
  try {
    for (const std::string& each : describeChange(known, after, grammar())) {
      told += (told.empty() ? "" : " ") + each;
    }
  } catch (const hyselam::InputError&) {
    told.clear();  // a name that cannot be put into words
  }
  out.sentences.push_back(told.empty() ? p.say("taken_down") : p.say("noted", {{"text", told}}));
}

void Dialogue::recordStatements(Turn& turn) {
  if (!turn.described) return;
  turn.described = false;
  const Change change(this, std::move(turn.known_before));  // names that come with statements, too
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const DescribedBuilding before = *turn.before;
  turn.before.reset();
  const std::vector<std::string> here = std::move(turn.here);
  turn.here.clear();
  const bool beyond_here = turn.beyond_here;
  const bool named_otherwise =
      !here.empty() && robot().place != 0 && isNamedOtherwise(robot().place, here);
  const bool changed = !(before == builder_.building());
  nameAsTold(before);
  readBack(before, !here.empty() && !beyond_here && places_.hasMap(), out);
  reportIssues(turn);
  const std::optional<DescriptionIssue> to_ask = std::move(turn.to_ask);
  turn.to_ask.reset();
  const bool asks_speaker = turn.asks_speaker;
  turn.asks_speaker = false;
  const bool known_already = !changed && beyond_here && !to_ask && !asks_speaker;
  if (known_already && out.sentences.empty()) out.sentences.push_back(p.say("known"));
  if (turn.sides && robot().has_pose) {
    heading_ = robot().pose.theta;
    position_ = hyselam::Point2{robot().pose.x, robot().pose.y};
  }
  turn.beyond_here = false;
  turn.sides = false;
  if (!places_.hasMap()) {
    out.sentences.push_back(p.say("no_map"));
    if (to_ask) askAboutIssue(*to_ask, asks_speaker, out);
    return;
  }
  if (!here.empty() && robot().place != 0) {
    if (question().place == robot().place) talk_.questions.drop();
    if (!named_otherwise && beyond_here) {
      places_.confirm(robot().place, here);
      giveNames(robot().place);
    } else if (!named_otherwise) {
      confirmNames(robot().place, here, out);
    }
    talk_.subject = robot().place;
  } else if (!here.empty() && !beyond_here) {
    out.sentences.push_back(p.say("no_place_here"));
  }
  if (beyond_here && changed) {
    matchDescription(out, true);
    out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  }
  if (named_otherwise) askAlso(robot().place, here, out);
  if (to_ask) askAboutIssue(*to_ask, asks_speaker, out);
}

void Dialogue::reportIssues(Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const DescriptionIssue* to_ask = nullptr;
  for (const DescriptionIssue& issue : turn.issues) {
    const bool asks = issue.kind == IssueKind::kAsk || issue.kind == IssueKind::kStrangeName;
    if (issue.kind == IssueKind::kNotice) {
      out.sentences.push_back(p.say("notice", {{"text", issue.text}, {"reason", issue.reason}}));
      continue;
    }
    out.refusals.push_back({issue.text, issue.reason, false, ""});
    if (asks && to_ask == nullptr) {
      to_ask = &issue;
    } else {
      out.sentences.push_back(p.say("issue", {{"text", issue.text}, {"reason", issue.reason}}));
    }
  }
  if (to_ask != nullptr) turn.to_ask = *to_ask;
  turn.issues.clear();
}

void Dialogue::askAboutIssue(const DescriptionIssue& issue, bool asks_speaker, Reply& out) {
  if (issue.kind == IssueKind::kStrangeName) {
    askNewName(0, {issue.name}, issue.text, out);
  } else if (asks_speaker) {
    Question question;
    question.kind = Question::Kind::kSpeaker;
    question.sentence = issue.text;
    ask(std::move(question), capital(issue.reason), out);
  } else {
    out.sentences.push_back(capital(issue.reason));
  }
}

void Dialogue::matchDescription(Reply& out, bool report) {
  if (talk_.is_trial) return;
  talk_.match.reset();
  talk_.unsure = {};
  const DescribedBuilding& building = builder_.building();
  if (!places_.hasMap() || building.places.empty()) return;
  const GuessedPlaces guessed_before = guessedPlaces(places_, building);
  MatchObserver observer;
  observer.heading = heading_;
  observer.position = position_;
  // Where the robot stood is confirmed as a name, not as an observer: it may have gone elsewhere.
  std::optional<MatchProblem> problem_to_ask;
  try {
    const MatchProblem problem =
        compileMatch(building, places_.map(), observer, constraintsOf(places_, builder_));
    talk_.match = solveExact(problem, params_.match);
    leaveWhereGuessed(guessed_before, problem, params_.match, building, &*talk_.match);
    if (report && params_.ask_from_afar && talk_.match->found()) problem_to_ask = problem;
    if (talk_.match->found()) {
      std::vector<std::pair<Id, std::vector<std::string>>> guesses;
      for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
        const int name = nameAt(talk_.match->best(), v);
        if (name < 0) continue;
        const DescribedPlace* place =
            building.findPlace(problem.names[static_cast<std::size_t>(name)]);
        if (!isCode(place->name)) guesses.emplace_back(problem.vertices[v], allNamesOf(*place));
      }
      places_.guess(guesses);
      talk_.unsure = uncertaintyOf(*talk_.match, problem, params_.match, building);
      // What people have confirmed is sure, whatever else they say of it.
      auto& unsure = talk_.unsure.names;
      for (auto name = unsure.begin(); name != unsure.end();) {
        const bool sure = !confirmedPlaces(*name).empty();
        if (sure) talk_.unsure.places.erase(*name);
        name = sure ? unsure.erase(name) : std::next(name);
      }
      auto& likely = talk_.unsure.likely;
      for (auto name = likely.begin(); name != likely.end();) {
        name = confirmedPlaces(name->first).empty() ? std::next(name) : likely.erase(name);
      }
    }
  } catch (const hyselam::InputError& e) {
    talk_.match.reset();
    if (report) out.sentences.push_back(phrases().say("cannot_match", {{"reason", e.what()}}));
    return;
  }
  const std::vector<MovedName> moved = movedNames(guessed_before, places_, building);
  if (report) reportMatch(moved, out);
  tellMoved(moved, report, out);
  if (problem_to_ask) askMostInformativeQuestion(*problem_to_ask, out);
}

void Dialogue::tellLikely(const std::vector<MovedName>& moved, Reply& out) {
  const Phrases& p = phrases();
  std::vector<std::string> items;
  std::map<std::string, Id> told;
  for (const auto& [name, id] : talk_.unsure.likely) {
    const Place* place = places_.map().findPlace(id);
    if (place == nullptr || isCode(name)) continue;
    const auto before = talk_.told_likely.find(name);
    const bool is_told = before != talk_.told_likely.end() && before->second == id;
    const bool is_moved =
        std::any_of(moved.begin(), moved.end(),
                    [&known = name](const auto& each) { return each.name == known; });
    told[name] = id;
    if (is_told || is_moved) continue;
    items.push_back(p.say("likely_item", {{"name", said(name)}, {"code", codeOf(*place)}}));
  }
  talk_.told_likely = std::move(told);
  if (!items.empty()) out.sentences.push_back(p.say("likely", {{"items", p.list(items)}}));
}

void Dialogue::reportMatch(const std::vector<MovedName>& moved, Reply& out) {
  const Phrases& p = phrases();
  const DescribedBuilding& building = builder_.building();
  std::vector<std::string> missing;
  std::size_t confirmed = 0;
  std::size_t all = 0;
  for (const DescribedPlace& place : building.places) {
    if (isCode(place.name)) continue;
    ++all;
    const std::vector<Id> found = places_.find(place.name);
    if (found.empty()) {
      missing.push_back(place.name);
    } else if (nameStateOf(*places_.map().findPlace(found.front())) == NameState::kConfirmed) {
      ++confirmed;
    }
  }
  // What was only named on the map counts, too.
  for (const Place& place : places_.map().places) {
    if (nameStateOf(place) != NameState::kConfirmed) continue;
    const std::vector<std::string> names = namesOf(place);
    const bool told = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return !builder_.find(name).empty();
    });
    if (told) continue;
    ++all;
    ++confirmed;
  }
  out.sentences.push_back(p.say("found", {{"found", std::to_string(all - missing.size())},
                                          {"told", std::to_string(all)},
                                          {"confirmed", std::to_string(confirmed)}}));
  tellLikely(moved, out);
  const std::vector<std::string> names(talk_.unsure.names.begin(), talk_.unsure.names.end());
  std::vector<std::string> without = missing;
  without.erase(std::remove_if(without.begin(), without.end(),
                               [&](const std::string& name) { return isOfOtherFloor(name); }),
                without.end());
  const bool asks = !without.empty() && names.empty();
  std::copy_if(names.begin(), names.end(), std::back_inserter(without), [&](const auto& name) {
    return std::find(missing.begin(), missing.end(), name) == missing.end();
  });
  if (!missing.empty())
    out.sentences.push_back(p.say("not_found", {{"names", p.list(said(missing))}}));
  if (asks) askWhere(out);
  wonder(std::move(without));
  std::vector<std::string> anywhere;
  std::copy_if(names.begin(), names.end(), std::back_inserter(anywhere),
               [&](const auto& name) { return talk_.unsure.likely.count(name) == 0; });
  if (anywhere.empty()) return;
  const std::string list = p.list(said(anywhere));
  if (talk_.unsure.answers < 2) {
    out.sentences.push_back(p.say("unsure", {{"names", list}}));
  } else if (talk_.unsure.more) {
    out.sentences.push_back(p.say("many_fit", {{"names", list}}));
  } else {
    const std::string number = std::to_string(talk_.unsure.answers);
    out.sentences.push_back(p.say("several", {{"number", number}, {"names", list}}));
  }
}

}  // namespace hyselam_topo

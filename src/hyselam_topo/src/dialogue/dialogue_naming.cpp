// Names of places: told one by one, by descriptions, and by answers to questions.
#include <algorithm>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue.hpp"
#include "hyselam_topo/topomerg_names.hpp"

namespace hyselam_topo {
namespace {

std::vector<std::string> allNamesOf(const DescribedPlace& place) {
  std::vector<std::string> names{place.name};
  names.insert(names.end(), place.aliases.begin(), place.aliases.end());
  return names;
}

constexpr double kWorthAsking = 0.2;  // [bits] that an answer must be worth to bother people

/// How a match names a place: the number of the name, -1 for none.
int nameAt(const MatchSolution& solution, std::size_t vertex) {
  return solution.assignment[vertex];
}

}  // namespace

// ---- Descriptions ----

void Dialogue::statement(const Utterance& u, Turn* turn) {
  const auto issues = builder_.add(u);
  turn->issues.insert(turn->issues.end(), issues.begin(), issues.end());
  turn->described = true;
  if (u.intent == "robot_in") {
    // Told from several places in thought, the first one is where the robot is.
    if (turn->here.empty()) {
      turn->here = textsOf(u.names("place"));
      const auto aliases = textsOf(u.names("aliases"));
      turn->here.insert(turn->here.end(), aliases.begin(), aliases.end());
    }
    return;
  }
  turn->beyond_here = true;
  if (!u.word("side").empty()) turn->sides = true;
  if (u.intent == "forget_place") {
    for (const std::string& name : textsOf(u.names("place"))) places_.forgetName(name);
  }
}

void Dialogue::takeDown(Turn* turn) {
  if (!turn->described) return;
  turn->described = false;
  Reply* out = &turn->reply;
  const Phrases& p = phrases();
  if (turn->beyond_here && places_.hasMap()) out->sentences.push_back(p.say("wait"));
  for (const DescriptionIssue& issue : turn->issues) {
    out->sentences.push_back(p.say(issue.kind == IssueKind::kNotice ? "notice" : "issue",
                                   {{"text", issue.text}, {"reason", issue.reason}}));
  }
  turn->issues.clear();
  if (turn->sides && robot().has_pose) heading_ = robot().pose.theta;
  const std::vector<std::string> here = std::move(turn->here);
  turn->here.clear();
  if (!places_.hasMap()) {
    out->sentences.push_back(p.say("taken_down"));
    out->sentences.push_back(p.say("no_map"));
    return;
  }
  const bool named_otherwise =
      !here.empty() && robot().place != 0 && isNamedOtherwise(robot().place, here);
  if (!here.empty() && robot().place != 0) {
    if (question_.place == robot().place) question_ = {};
    if (!named_otherwise && turn->beyond_here) {
      places_.confirm(robot().place, here);
    } else if (!named_otherwise) {
      nameHere(robot().place, here, out);
    }
    subject_ = robot().place;
  } else if (!here.empty() && !turn->beyond_here) {
    out->sentences.push_back(p.say("no_place_here"));
  }
  if (turn->beyond_here) {
    solve(out, true);
    out->actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  }
  turn->beyond_here = false;
  turn->sides = false;
  if (named_otherwise) askAlso(robot().place, here, out);
}

MatchConstraints Dialogue::constraints() const {
  MatchConstraints constraints;
  const auto described = [&](const std::string& name) -> Id {
    const std::vector<Id> found = builder_.find(name);
    return found.size() == 1 ? found.front() : 0;
  };
  for (const Place& place : places_.map().places) {
    if (nameStateOf(place) != NameState::kConfirmed) continue;
    Id id = 0;
    for (const std::string& name : namesOf(place)) {
      if (id == 0) id = described(name);
    }
    if (id != 0) {
      constraints.confirmed.emplace_back(place.id, id);
    } else {
      constraints.unnamed.push_back(place.id);
    }
  }
  std::set<std::pair<Id, Id>> excluded;
  for (const auto& [place, name] : places_.state().rejected) {
    const Id id = described(name);
    const std::pair<Id, Id> pair{place, id};
    const bool settled =
        std::any_of(constraints.confirmed.begin(), constraints.confirmed.end(),
                    [&](const auto& c) { return c.first == pair.first; }) ||
        std::count(constraints.unnamed.begin(), constraints.unnamed.end(), pair.first) > 0;
    if (id != 0 && !settled) excluded.insert(pair);
  }
  constraints.excluded.assign(excluded.begin(), excluded.end());
  return constraints;
}

void Dialogue::solve(Reply* out, bool tell) {
  match_.reset();
  const DescribedBuilding& building = builder_.building();
  if (!places_.hasMap() || building.places.empty()) return;
  MatchObserver observer;
  observer.heading = heading_;
  // Where the robot stood is confirmed as a name, not as an observer: it may have gone elsewhere.
  std::optional<MatchProblem> problem_to_ask;
  try {
    const MatchProblem problem = compileMatch(building, places_.map(), observer, constraints());
    match_ = solveExact(problem, params_.match);
    if (tell && params_.ask_from_afar && match_->found()) problem_to_ask = problem;
    if (match_->found()) {
      std::vector<std::pair<Id, std::vector<std::string>>> guesses;
      for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
        const int name = nameAt(match_->best(), v);
        if (name < 0) continue;
        const DescribedPlace* place =
            building.findPlace(problem.names[static_cast<std::size_t>(name)]);
        guesses.emplace_back(problem.vertices[v], allNamesOf(*place));
      }
      places_.guess(guesses);
    }
  } catch (const hyselam::InputError& e) {
    match_.reset();
    if (tell) out->sentences.push_back(phrases().say("cannot_match", {{"reason", e.what()}}));
    return;
  }
  if (tell) tellMatch(out);
  if (problem_to_ask) askFromAfar(*problem_to_ask, out);
}

void Dialogue::tellMatch(Reply* out) const {
  const Phrases& p = phrases();
  const DescribedBuilding& building = builder_.building();
  out->sentences.push_back(p.say("done"));
  std::vector<std::string> missing;
  for (const DescribedPlace& place : building.places) {
    if (places_.find(place.name).empty()) missing.push_back(place.name);
  }
  const std::size_t all = building.places.size();
  out->sentences.push_back(p.say(
      "found", {{"found", std::to_string(all - missing.size())}, {"told", std::to_string(all)}}));
  if (!missing.empty()) out->sentences.push_back(p.say("not_found", {{"names", p.list(missing)}}));
  if (!match_ || match_->equal < 2) return;
  // The names that equally good answers put in different places. Answers that only give a name more
  // places say less than the one with the fewest, which is taken.
  const std::size_t known = std::min(match_->equal, match_->solutions.size());
  std::size_t equal = 0;
  std::set<int> unsure;
  for (std::size_t s = 0; s < known; ++s) {
    if (match_->solutions[s].vertices != match_->best().vertices) continue;
    ++equal;
    for (std::size_t v = 0; v < match_->best().assignment.size(); ++v) {
      const int here = nameAt(match_->best(), v), there = nameAt(match_->solutions[s], v);
      if (here == there) continue;
      unsure.insert(here);
      unsure.insert(there);
    }
  }
  if (equal < 2) return;
  std::vector<std::string> names;
  for (const int name : unsure) {
    if (name >= 0) names.push_back(building.places[static_cast<std::size_t>(name)].name);
  }
  const std::string number = std::to_string(equal) + (match_->more ? "+" : "");
  out->sentences.push_back(p.say("several", {{"number", number}, {"names", p.list(names)}}));
}

/// The question that tells the answers that fit about as well apart best.
void Dialogue::askFromAfar(const MatchProblem& problem, Reply* out) {
  if (question_.kind != Question::Kind::kNone) return;
  const auto best = mostInformativeQuestion(problem, *match_);
  if (!best || best->bits < kWorthAsking) return;
  const Place& place = *places_.map().findPlace(best->place);
  question_.place = place.id;
  const bool guessed = nameStateOf(place) == NameState::kUnconfirmed;
  question_.kind = guessed ? Question::Kind::kConfirmName : Question::Kind::kName;
  if (guessed) question_.names = namesOf(place);
  out->sentences.push_back(
      guessed ? phrases().say("ask_confirm_there",
                              {{"code", codeOf(place)}, {"names", phrases().list(question_.names)}})
              : phrases().say("ask_name_there", {{"code", codeOf(place)}}));
}

// ---- One name ----

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

void Dialogue::askAlso(Id place, const std::vector<std::string>& names, Reply* out) {
  const Phrases& p = phrases();
  question_ = {};
  question_.kind = Question::Kind::kAlsoName;
  question_.place = place;
  question_.names = names;
  const std::vector<std::string> known = namesOf(*places_.map().findPlace(place));
  out->sentences.push_back(p.say(
      "ask_also", {{"known", p.list(known)}, {"names", p.list(names)}, {"name", names.front()}}));
}

void Dialogue::nameHere(Id place, const std::vector<std::string>& names, Reply* out) {
  const Phrases& p = phrases();
  const std::vector<Id> losers = places_.confirm(place, names);
  const Place& named = *places_.map().findPlace(place);
  out->sentences.push_back(
      p.say("named", {{"code", codeOf(named)}, {"names", p.list(namesOf(named))}}));
  for (const Id loser : losers) {
    out->sentences.push_back(
        p.say("moved_name", {{"code", codeOf(*places_.map().findPlace(loser))}}));
  }
  if (question_.place == place) question_ = {};
  subject_ = place;
  solve(out, false);
  out->actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

Reply Dialogue::name(Id place, const std::vector<std::string>& names) {
  if (names.empty()) throw hyselam::InputError("name", "", "there is none");
  if (places_.map().findPlace(place) == nullptr) {
    throw hyselam::InputError("places", "id " + std::to_string(place), "there is no such place");
  }
  Reply out = reply();
  nameHere(place, names, &out);
  return out;
}

Reply Dialogue::forget(Id place) {
  Reply out = reply();
  places_.forget(place);
  out.sentences.push_back(phrases().say("forgot_names", {{"places", label(place)}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

void Dialogue::thisIs(const Utterance& u, Turn* turn) {
  Reply* out = &turn->reply;
  if (robot().place == 0) {
    out->sentences.push_back(phrases().say(places_.hasMap() ? "no_place_here" : "no_map"));
    return;
  }
  std::vector<std::string> names = textsOf(u.names("place"));
  const auto aliases = textsOf(u.names("aliases"));
  names.insert(names.end(), aliases.begin(), aliases.end());
  // "The name of this place is ..." right after a question about another place answers that.
  const Id place = question_.kind == Question::Kind::kName ? question_.place : robot().place;
  if (names.empty()) return;
  if (isNamedOtherwise(place, names)) {
    askAlso(place, names, out);
  } else {
    nameHere(place, names, out);
  }
}

void Dialogue::forgetNames(const Utterance& u, Turn* turn) {
  Reply* out = &turn->reply;
  const Phrases& p = phrases();
  if (!u.word("all").empty() || u.find("all") != nullptr) {
    places_.forgetAllNames();
    out->sentences.push_back(p.say("forgot_all"));
    out->actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
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
  if (question_.kind == Question::Kind::kConfirmName) question_ = {};
  out->sentences.push_back(p.say(had ? "forgot_names" : "no_names", {{"places", p.list(codes)}}));
  out->actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::rename(const Utterance& u, Turn* turn) {
  Reply* out = &turn->reply;
  const std::vector<Id> found = resolve(u, "place", out);
  const auto names = textsOf(u.names("name"));
  if (found.empty() || names.empty()) return;
  for (const Id id : found) {
    places_.forget(id);
    nameHere(id, {names.front()}, out);
  }
}

// ---- Questions and answers ----

void Dialogue::askConfirm(Id place, Reply* out) {
  const Place& p = *places_.map().findPlace(place);
  question_ = {};
  question_.kind = Question::Kind::kConfirmName;
  question_.place = place;
  question_.names = namesOf(p);
  out->sentences.push_back(
      phrases().say("ask_confirm", {{"names", phrases().list(question_.names)}}));
}

void Dialogue::askName(Id place, Reply* out) {
  question_ = {};
  question_.kind = Question::Kind::kName;
  question_.place = place;
  out->sentences.push_back(phrases().say("ask_name"));
}

/// A guess was wrong: the next one, or the question for the name.
void Dialogue::notConfirmed(Reply* out) {
  const Question asked = question_;
  question_ = {};
  if (places_.map().findPlace(asked.place) == nullptr) return;
  places_.reject(asked.place, asked.names);
  solve(out, false);
  out->actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  if (nameStateOf(*places_.map().findPlace(asked.place)) == NameState::kUnconfirmed) {
    askConfirm(asked.place, out);
  } else {
    askName(asked.place, out);
  }
}

void Dialogue::answer(const Utterance& u, Turn* turn) {
  Reply* out = &turn->reply;
  const Phrases& p = phrases();
  using Kind = Question::Kind;
  const auto length = u.number("length") ? u.number("length") : u.number("radius");
  if (question_.kind == Kind::kNone) {
    out->sentences.push_back(p.say("nothing_asked"));
  } else if (u.intent == "unknown_answer") {
    question_ = {};
    out->sentences.push_back(p.say("cancelled"));
  } else if (u.intent == "name_answer") {
    const auto names = textsOf(u.names("place"));
    const Question asked = question_;
    if (names.empty() || asked.place == 0) return;
    const bool as_guessed =
        asked.kind == Kind::kConfirmName &&
        std::any_of(asked.names.begin(), asked.names.end(),
                    [&](const std::string& name) { return places_.sameName(name, names[0]); });
    if (asked.kind == Kind::kConfirmName && !as_guessed) places_.reject(asked.place, asked.names);
    nameHere(asked.place, as_guessed ? asked.names : names, out);
  } else if ((u.intent == "length_answer" || u.intent == "radius_answer") && length) {
    if (question_.kind == Kind::kRadius) {
      const Question asked = question_;
      question_ = {};
      addVirtualAndAsk(asked.point, *length, asked.names, out);
    } else if (question_.search) {
      askWall(question_.search->ofLength(*length), out);
    } else {
      out->sentences.push_back(p.say("nothing_asked"));
    }
  } else if (u.intent == "yes" &&
             (question_.kind == Kind::kConfirmName || question_.kind == Kind::kAlsoName)) {
    const Question asked = question_;
    nameHere(asked.place, asked.names, out);
  } else if (u.intent == "yes" && question_.kind == Kind::kWall) {
    const ToldWall wall = question_.wall;
    question_ = {};
    places_.addWall(wall);
    out->sentences.push_back(p.say("wall_added", {{"wall", p.wall(wall.kind)}}));
    out->actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
    out->actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  } else if (u.intent == "no" && question_.kind == Kind::kConfirmName) {
    notConfirmed(out);
  } else if (u.intent == "no" && question_.kind == Kind::kWall) {
    question_.kind = Kind::kWallLength;
    question_.search->reject(question_.wall.line);
    out->sentences.push_back(p.say("ask_wall_length", {{"wall", p.wall(question_.wall.kind)}}));
  } else if (u.intent == "no") {
    if (question_.kind == Kind::kAlsoName) {
      // What was described from here is told of the place that it is.
      if (builder_.building().robot_place) {
        builder_.setRobotPlace(namesOf(*places_.map().findPlace(question_.place)).front());
      }
      out->sentences.push_back(p.say(
          "at_named", {{"code", codeOf(*places_.map().findPlace(question_.place))},
                       {"names", p.list(namesOf(*places_.map().findPlace(question_.place)))}}));
    }
    question_ = {};
    out->sentences.push_back(p.say("cancelled"));
  } else {
    out->sentences.push_back(p.say("nothing_asked"));
  }
}

}  // namespace hyselam_topo

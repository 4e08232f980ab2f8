// Descriptions of the building: recorded, matched with the map, the result reported.
#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "match_constraints.hpp"

namespace hyselam_topo {

void Dialogue::addStatement(const Utterance& u, Turn& turn) {
  const auto issues = builder_.add(u);
  turn.issues.insert(turn.issues.end(), issues.begin(), issues.end());
  turn.described = true;
  if (u.intent == "robot_in") {
    // Described from several places in thought, the first one is where the robot is.
    if (turn.here.empty()) {
      turn.here = textsOf(u.names("place"));
      const auto aliases = textsOf(u.names("aliases"));
      turn.here.insert(turn.here.end(), aliases.begin(), aliases.end());
    }
    return;
  }
  turn.beyond_here = true;
  if (!u.word("side").empty()) turn.sides = true;
  if (u.intent == "forget_place") {
    for (const std::string& name : textsOf(u.names("place"))) places_.forgetName(name);
  }
}

void Dialogue::recordStatements(Turn& turn) {
  if (!turn.described) return;
  turn.described = false;
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  if (turn.beyond_here && places_.hasMap()) out.sentences.push_back(p.say("wait"));
  for (const DescriptionIssue& issue : turn.issues) {
    out.sentences.push_back(p.say(issue.kind == IssueKind::kNotice ? "notice" : "issue",
                                  {{"text", issue.text}, {"reason", issue.reason}}));
    if (issue.kind != IssueKind::kNotice) {
      out.refusals.push_back({issue.text, issue.reason, false, ""});
    }
  }
  turn.issues.clear();
  if (turn.sides && robot().has_pose) {
    heading_ = robot().pose.theta;
    position_ = hyselam::Point2{robot().pose.x, robot().pose.y};
  }
  const std::vector<std::string> here = std::move(turn.here);
  turn.here.clear();
  if (!places_.hasMap()) {
    out.sentences.push_back(p.say("taken_down"));
    out.sentences.push_back(p.say("no_map"));
    return;
  }
  const bool named_otherwise =
      !here.empty() && robot().place != 0 && isNamedOtherwise(robot().place, here);
  if (!here.empty() && robot().place != 0) {
    if (question_.place == robot().place) question_ = {};
    if (!named_otherwise && turn.beyond_here) {
      places_.confirm(robot().place, here);
    } else if (!named_otherwise) {
      confirmNames(robot().place, here, out);
    }
    subject_ = robot().place;
  } else if (!here.empty() && !turn.beyond_here) {
    out.sentences.push_back(p.say("no_place_here"));
  }
  if (turn.beyond_here) {
    matchDescription(out, true);
    out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  }
  turn.beyond_here = false;
  turn.sides = false;
  if (named_otherwise) askAlso(robot().place, here, out);
}

void Dialogue::matchDescription(Reply& out, bool report) {
  match_.reset();
  const DescribedBuilding& building = builder_.building();
  if (!places_.hasMap() || building.places.empty()) return;
  MatchObserver observer;
  observer.heading = heading_;
  observer.position = position_;
  // Where the robot stood is confirmed as a name, not as an observer: it may have gone elsewhere.
  std::optional<MatchProblem> problem_to_ask;
  try {
    const MatchProblem problem =
        compileMatch(building, places_.map(), observer, constraintsOf(places_, builder_));
    match_ = solveExact(problem, params_.match);
    if (report && params_.ask_from_afar && match_->found()) problem_to_ask = problem;
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
    if (report) out.sentences.push_back(phrases().say("cannot_match", {{"reason", e.what()}}));
    return;
  }
  if (report) reportMatch(out);
  if (problem_to_ask) askMostInformativeQuestion(*problem_to_ask, out);
}

void Dialogue::reportMatch(Reply& out) const {
  const Phrases& p = phrases();
  const DescribedBuilding& building = builder_.building();
  out.sentences.push_back(p.say("done"));
  std::vector<std::string> missing;
  std::size_t confirmed = 0;
  for (const DescribedPlace& place : building.places) {
    const std::vector<Id> found = places_.find(place.name);
    if (found.empty()) {
      missing.push_back(place.name);
    } else if (nameStateOf(*places_.map().findPlace(found.front())) == NameState::kConfirmed) {
      ++confirmed;
    }
  }
  const std::size_t all = building.places.size();
  out.sentences.push_back(p.say("found", {{"found", std::to_string(all - missing.size())},
                                          {"told", std::to_string(all)},
                                          {"confirmed", std::to_string(confirmed)}}));
  if (!missing.empty()) out.sentences.push_back(p.say("not_found", {{"names", p.list(missing)}}));
  if (!match_ || match_->equal < 2) return;
  const EqualAnswers equal = equalAnswers(*match_);
  if (equal.count < 2) return;
  std::vector<std::string> names;
  for (const int name : equal.unsure) {
    names.push_back(building.places[static_cast<std::size_t>(name)].name);
  }
  const std::string number = std::to_string(equal.count) + (match_->more ? "+" : "");
  out.sentences.push_back(p.say("several", {{"number", number}, {"names", p.list(names)}}));
}

}  // namespace hyselam_topo

// Driving: goals, ways to them, and whether the robot is under way.
#include <algorithm>
#include <cmath>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/side_angle.hpp"
#include "neighbors.hpp"
#include "way_obstacles.hpp"

namespace hyselam_topo {
namespace {

/// A robot that has not moved for so long stands [s].
constexpr double kStands = 3.0;

}  // namespace

void Dialogue::goTo(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const std::vector<SaidName> near = u.names("near");
  std::vector<Id> beside;
  if (!near.empty()) {
    beside = resolve(near.front(), out);
    if (beside.empty()) return;
  }
  for (const SaidName& name : u.names("places")) {
    std::vector<Id> found = resolve(name, out);
    if (found.empty()) continue;
    if (!beside.empty()) {
      const std::vector<Id> good = neighborsOf(places_.map(), beside);
      std::vector<Id> both;
      for (const Id id : found) {
        if (std::count(good.begin(), good.end(), id) > 0) both.push_back(id);
      }
      if (!both.empty()) found = both;
    }
    turn.goals.emplace_back(name.text, std::move(found));
  }
  const bool comes_back = !u.word("back").empty() && !turn.goals.empty();
  if (comes_back && robot().place != 0) {
    turn.goals.emplace_back(shortName(robot().place), std::vector<Id>{robot().place});
  }
}

void Dialogue::goToPreviousPlace(const Utterance&, Turn& turn) {
  const Id previous = robot().previous;
  if (previous == 0) {
    say("no_previous", turn);
  } else {
    turn.goals.emplace_back(shortName(previous), std::vector<Id>{previous});
  }
}

void Dialogue::followPerson(const Utterance&, Turn& turn) {
  turn.reply.actions.push_back({DialogueAction::Kind::kFollow, {}, 0.0});
  talk_.way.clear();
  setOut(0);
  say("following", turn);
}

void Dialogue::turnRobot(const Utterance& u, Turn& turn) {
  const auto side = sideOf(u.word("direction"));
  if (!side || *side == Side::kUnknown) {
    say("cannot_do", turn);
    return;
  }
  const double angle = angleOf(*side);
  turn.reply.actions.push_back({DialogueAction::Kind::kTurn, {}, angle});
  talk_.way.clear();
  setOut(robot().place);
  turn.reply.sentences.push_back(phrases().say("turning", {{"side", phrases().side(*side)}}));
}

std::string Dialogue::haltedGoal() const {
  if (!talk_.halted || talk_.way.empty() || talk_.under_way) return "";
  return said(talk_.way.back().first);
}

void Dialogue::carryOn(const Utterance&, Turn& turn) {
  if (!haltedGoal().empty()) {
    drive(std::vector<NamedGoal>(talk_.way), turn.reply);
  } else {
    say("nowhere_to_go_on", turn);
  }
}

void Dialogue::stop(const Utterance&, Turn& turn) {
  talk_.questions.drop();
  turn.goals.clear();
  halt(turn.reply);
  say("stopped", turn);
}

void Dialogue::cancel(const Utterance&, Turn& turn) {
  talk_.questions.drop();
  turn.goals.clear();
  halt(turn.reply);
  talk_.halted = false;  // nothing to go on with
  say("cancelled", turn);
}

Reply Dialogue::goTo(const std::string& name, const std::vector<Id>& places) {
  Turn turn;
  turn.reply = reply();
  if (places.empty()) {
    turn.reply.sentences.push_back(phrases().say("unknown_place", {{"name", name}}));
    return turn.reply;
  }
  turn.goals.emplace_back(name, places);
  startGoal(turn);
  return turn.reply;
}

bool Dialogue::isUnsure(const NamedGoal& goal) const {
  if (isCode(goal.first)) return false;
  const bool guessed = std::all_of(goal.second.begin(), goal.second.end(), [&](Id id) {
    return nameStateOf(*places_.map().findPlace(id)) == NameState::kUnconfirmed;
  });
  return guessed &&
         std::any_of(talk_.unsure.names.begin(), talk_.unsure.names.end(), [&](const auto& name) {
           if (places_.sameName(name, goal.first)) return true;
           const std::vector<Id> found = places_.find(name);
           return std::find_first_of(found.begin(), found.end(), goal.second.begin(),
                                     goal.second.end()) != found.end();
         });
}

void Dialogue::startGoal(Turn& turn) {
  if (turn.goals.empty()) return;
  const std::vector<NamedGoal> goals = std::move(turn.goals);
  turn.goals.clear();
  std::vector<std::string> unsure;
  std::vector<Id> perhaps;
  for (const NamedGoal& goal : goals) {
    if (!isUnsure(goal)) continue;
    unsure.push_back(goal.first);
    perhaps.push_back(goal.second.front());
  }
  if (unsure.empty()) {
    drive(goals, turn.reply);
    return;
  }
  const Phrases& p = phrases();
  Question question;
  question.kind = Question::Kind::kGo;
  question.goals = goals;
  ask(std::move(question),
      p.say("ask_go", {{"names", p.list(said(unsure))}, {"places", p.list(labels(perhaps))}}),
      turn.reply);
}

void Dialogue::drive(const std::vector<NamedGoal>& goals, Reply& out) {
  const Phrases& p = phrases();
  if (!robot().has_pose) {
    out.sentences.push_back(p.say("at_unknown"));
    return;
  }
  DialogueAction action;
  action.kind = DialogueAction::Kind::kGo;
  hyselam::Pose2 from = robot().pose;
  std::vector<Id> stops;
  std::vector<std::string> told;
  bool closed = false;
  for (const auto& [name, places] : goals) {
    const auto leg = route(from, places);
    if (!leg) {
      out.sentences.push_back(p.say("no_way", {{"place", said(name)}}));
      tellWallInTheWay(from, places, goals, out);
      return;
    }
    from = leg->waypoints.back();
    stops.push_back(leg->places.back());
    const bool by_code = isCode(name) && nameStateOf(*places_.map().findPlace(stops.back())) !=
                                             NameState::kConfirmed;
    told.push_back(by_code ? codeOf(*places_.map().findPlace(stops.back()))
                           : labels({stops.back()}).front());
    closed = closed || hasClosedDoor(places_.map(), *leg);
    action.legs.push_back(*leg);
  }
  out.sentences.push_back(p.say("going", {{"places", p.list(told)}}));
  if (closed) out.sentences.push_back(p.say("door_closed"));
  out.actions.push_back(std::move(action));
  talk_.way = goals;
  setOut(stops.back());
}

std::optional<RouteLeg> Dialogue::route(const hyselam::Pose2& from,
                                        const std::vector<Id>& goals) const {
  return planRoute(places_.map(), from, goals, params_.route, places_.shutDoors());
}

// ---- Under way ----

void Dialogue::setOut(Id to) {
  talk_.under_way = to;
  talk_.halted = false;
  talk_.stood_at = robot().pose;
  talk_.stands_since = robot().stamp;
}

void Dialogue::seeWhetherArrived() {
  const hyselam::Pose2& pose = robot().pose;
  const bool moved = std::hypot(pose.x - talk_.stood_at.x, pose.y - talk_.stood_at.y) > 0.05 ||
                     std::abs(hyselam::normalizeAngle(pose.theta - talk_.stood_at.theta)) > 0.05;
  if (moved || robot().stamp < talk_.stands_since) {
    talk_.stood_at = pose;
    talk_.stands_since = robot().stamp;
  }
  const bool there = talk_.under_way && *talk_.under_way != 0 && *talk_.under_way == robot().place;
  if (there && robot().stamp - talk_.stands_since >= kStands) talk_.under_way.reset();
}

void Dialogue::halt(Reply& out) {
  talk_.halted = talk_.halted || (talk_.under_way && !talk_.way.empty());
  talk_.under_way.reset();
  out.actions.push_back({DialogueAction::Kind::kStop, {}, 0.0});
}

void Dialogue::haltAtDoor(const DescribedWall& wall, Reply& out) {
  if (!talk_.under_way || places_.doorShutBy(wall) == nullptr) return;
  halt(out);
  out.sentences.push_back(phrases().say("stopped"));
}

// ---- What it cannot do ----

void Dialogue::refuseCorridor(const Utterance&, Turn& turn) {
  say("cannot_follow", turn);
}

void Dialogue::refuseComing(const Utterance&, Turn& turn) {
  say("cannot_come", turn);
}

void Dialogue::refuseCarrying(const Utterance& u, Turn& turn) {
  const std::vector<SaidName> to = u.names("to");
  if (to.empty()) {
    turn.reply.unknown_name = true;  // of a thing: another node may know it
    say("cannot_carry", turn);
    return;
  }
  turn.reply.sentences.push_back(
      phrases().say("cannot_carry_there", {{"place", said(to.front().text)}}));
}

}  // namespace hyselam_topo

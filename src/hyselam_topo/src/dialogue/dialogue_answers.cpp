// Driving, and answers to questions about the building.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/topomerg/shared_walls.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

namespace hyselam_topo {
namespace {

std::vector<Id> neighborsOf(const AugmentedTopologicalMap& map, const std::vector<Id>& places) {
  std::set<Id> all;
  for (const Edge& edge : map.edges) {
    for (const Id place : places) {
      if (edge.a == place) all.insert(edge.b);
      if (edge.b == place) all.insert(edge.a);
    }
  }
  for (const Id place : places) all.erase(place);
  return {all.begin(), all.end()};
}

/// What lies behind their walls, without a door to them.
std::vector<Id> placesBehind(const AugmentedTopologicalMap& map, const std::vector<Id>& places) {
  const std::vector<Id> neighbors = neighborsOf(map, places);
  std::vector<Id> behind;
  const auto isIn = [](const std::vector<Id>& list, Id id) {
    return std::find(list.begin(), list.end(), id) != list.end();
  };
  for (const SharedWall& wall : sharedWalls(map)) {
    const Id a = map.places[wall.a].id, b = map.places[wall.b].id;
    for (const auto& [here, there] : {std::pair(a, b), std::pair(b, a)}) {
      if (!isIn(places, here) || isIn(places, there) || isIn(neighbors, there)) continue;
      if (!isIn(behind, there)) behind.push_back(there);
    }
  }
  return behind;
}

bool hasClosedDoor(const AugmentedTopologicalMap& map, const RouteLeg& leg) {
  for (const Edge& edge : map.edges) {
    for (const Door& door : edge.doors) {
      if (door.state == DoorState::kClosed &&
          std::find(leg.doors.begin(), leg.doors.end(), door.id) != leg.doors.end()) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

// ---- Going ----

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
  const double angle = *side == Side::kLeft    ? 0.5 * hyselam::kPi
                       : *side == Side::kRight ? -0.5 * hyselam::kPi
                                               : hyselam::kPi;
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

// ---- Questions ----

void Dialogue::answerWhereAreYou(const Utterance&, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const Id here = robot().place;
  if (here == 0) {
    out.sentences.push_back(p.say("at_unknown"));
    return;
  }
  talk_.subject = here;
  const Place& place = *places_.map().findPlace(here);
  const std::string code = codeOf(place);
  if (nameStateOf(place) == NameState::kConfirmed) {
    out.sentences.push_back(
        p.say("at_named", {{"code", code}, {"names", p.list(said(namesOf(place)))}}));
  } else {
    out.sentences.push_back(p.say("at_code", {{"code", code}}));
  }
  if (robot().in_doorway) out.sentences.push_back(p.say("in_doorway"));
  if (nameStateOf(place) == NameState::kUnconfirmed) askConfirm(here, out);
}

void Dialogue::answerWhereIs(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const std::vector<Id> found = resolve(u, "place", out);
  if (found.empty()) return;
  std::string name = shortName(found.front());
  const Id here = robot().place;
  const bool at = std::count(found.begin(), found.end(), here) > 0;
  const Place& asked_for = *places_.map().findPlace(at ? here : found.front());
  const bool guessed = nameStateOf(asked_for) == NameState::kUnconfirmed;
  if (u.intent == "is_here" && here != 0 && !guessed) {
    out.sentences.push_back(p.say(at ? "yes" : "no"));
  }
  if (guessed) {
    const std::string bare = subject(name) == name ? name : said(name);
    name = capital(p.say("perhaps_is", {{"name", bare}}));
  } else {
    name = subject(name);
  }
  if (at) {
    const Place& place = asked_for;
    out.sentences.push_back(p.say("where_is_here", {{"name", name}, {"code", codeOf(place)}}));
    if (guessed) askConfirm(here, out);
    return;
  }
  const auto leg = robot().has_pose ? route(robot().pose, found) : std::optional<RouteLeg>();
  const Id nearest = leg ? leg->places.back() : found.front();
  const std::string code = codeOf(*places_.map().findPlace(nearest));
  if (leg) {
    out.sentences.push_back(
        p.say("where_is", {{"name", name}, {"code", code}, {"length", p.number(leg->length, 0)}}));
  } else {
    out.sentences.push_back(p.say("where_is_no_way", {{"name", name}, {"code", code}}));
    if (robot().has_pose) tellWallInTheWay(robot().pose, found, {}, out);
  }
}

void Dialogue::answerRouteTo(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const std::vector<Id> goals = resolve(u, "place", out);
  if (goals.empty()) return;
  std::optional<hyselam::Pose2> from;
  if (robot().has_pose) from = robot().pose;
  if (!u.names("from").empty()) {
    const std::vector<Id> starts = resolve(u, "from", out);
    if (starts.empty()) return;
    const auto pose = placePose(places_.map(), starts.front());
    from = pose ? std::optional<hyselam::Pose2>(pose->pose) : std::nullopt;
  }
  const auto leg = from ? route(*from, goals) : std::optional<RouteLeg>();
  const std::string place = said(shortName(goals.front()));
  if (!leg) {
    out.sentences.push_back(p.say("no_way", {{"place", place}}));
    if (from) tellWallInTheWay(*from, goals, {}, out);
    return;
  }
  out.sentences.push_back(p.say("way", {{"place", place},
                                        {"length", p.number(leg->length, 0)},
                                        {"places", p.list(labels(leg->places))}}));
  if (hasClosedDoor(places_.map(), *leg)) out.sentences.push_back(p.say("door_closed"));
}

void Dialogue::answerNextTo(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const std::vector<Id> found = resolve(u, "place", out);
  if (found.empty()) return;
  const std::vector<Id> neighbors = neighborsOf(places_.map(), found);
  const std::vector<Id> behind = placesBehind(places_.map(), found);
  const std::string place = said(shortName(found.front()));
  if (!neighbors.empty()) {
    out.sentences.push_back(
        p.say("next_to", {{"place", place}, {"places", p.list(labels(neighbors))}}));
  }
  if (!behind.empty()) {
    out.sentences.push_back(p.say(neighbors.empty() ? "next_to_behind" : "next_behind",
                                  {{"place", place}, {"places", p.list(labels(behind))}}));
  }
  if (neighbors.empty() && behind.empty()) {
    out.sentences.push_back(p.say("next_to_nothing", {{"place", place}}));
  }
}

/// What was described; geometry would not know what people take for opposite.
void Dialogue::answerOpposite(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const auto names = textsOf(u.names("place"));
  std::vector<std::string> described;
  if (!names.empty()) {
    const std::vector<Id> found = builder_.find(names.front());
    for (const DescribedRelation& r : builder_.building().relations) {
      if (r.kind != RelationKind::kOpposite) continue;
      for (const Id id : found) {
        const Id other = r.a == id ? r.b : r.b == id ? r.a : 0;
        if (other != 0) described.push_back(builder_.building().findPlace(other)->name);
      }
    }
  }
  const std::string place = names.empty() ? "" : said(names.front());
  if (described.empty()) {
    out.sentences.push_back(p.say("opposite_unknown", {{"place", place}}));
  } else {
    out.sentences.push_back(
        p.say("opposite", {{"place", place}, {"places", p.list(said(described))}}));
  }
}

void Dialogue::answerOnSide(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const auto side = sideOf(u.word("side"));
  if (!side || *side == Side::kUnknown || robot().place == 0) {
    out.sentences.push_back(p.say("at_unknown"));
    return;
  }
  const double direction = *side == Side::kLeft    ? 0.5 * hyselam::kPi
                           : *side == Side::kRight ? -0.5 * hyselam::kPi
                           : *side == Side::kBack  ? hyselam::kPi
                                                   : 0.0;
  // Down a corridor most doors are rather ahead than beside, and yet people call them left or
  // right.
  const bool across = *side == Side::kLeft || *side == Side::kRight;
  const double reach = hyselam::radians(across ? 70.0 : 20.0);
  std::vector<std::pair<double, Id>> seen;
  for (const Edge& edge : places_.map().edges) {
    if (edge.a != robot().place && edge.b != robot().place) continue;
    const Id other = edge.a == robot().place ? edge.b : edge.a;
    for (const Door& door : edge.doors) {
      const hyselam::Point2 at =
          robot().pose.inverse() * hyselam::Point2{door.position.x, door.position.y};
      const double off = hyselam::normalizeAngle(std::atan2(at.y, at.x) - direction);
      if (std::abs(off) <= reach) seen.emplace_back(std::hypot(at.x, at.y), other);
    }
  }
  std::sort(seen.begin(), seen.end());
  std::vector<Id> places;
  for (const auto& [distance, id] : seen) {
    if (std::count(places.begin(), places.end(), id) == 0) places.push_back(id);
  }
  // What was told and no door of the map shows, as it is seen from here now.
  SaidName here;
  here.reference = "here";
  std::vector<std::string> told;
  const std::vector<Id> at = described(here);
  for (const DescribedConnection& each : builder_.building().connections) {
    const bool from_here = std::find(at.begin(), at.end(), each.from) != at.end();
    const Side now = sideSeenFrom(each.side, each.seen_from,
                                  robot().has_pose ? std::optional(robot().pose) : std::nullopt);
    if (!from_here || now != *side) continue;
    const DescribedPlace* place = builder_.building().findPlace(each.to);
    const std::vector<Id> known = place == nullptr ? std::vector<Id>() : places_.find(place->name);
    const bool seen_there =
        std::find_first_of(known.begin(), known.end(), places.begin(), places.end()) != known.end();
    if (place != nullptr && !isCode(place->name) && !seen_there) told.push_back(place->name);
  }
  if (!told.empty())
    out.sentences.push_back(p.say("found_there", {{"places", p.list(said(told))}}));
  if (places.empty() && told.empty()) {
    out.sentences.push_back(p.say("nothing_on_side", {{"side", p.side(*side)}}));
  } else if (!places.empty()) {
    out.sentences.push_back(
        p.say("on_side", {{"side", p.side(*side)}, {"places", p.list(labels(places))}}));
  }
}

void Dialogue::answerSize(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const std::vector<Id> found = resolve(u, "place", out);
  if (found.empty()) return;
  double area = 0.0;
  for (const Id id : found) area += places_.map().findPlace(id)->area;
  const std::string place = shortName(found.front());
  if (area > 0.0) {
    out.sentences.push_back(
        p.say("size", {{"place", subject(place)}, {"area", p.number(area, 1)}}));
  } else {
    out.sentences.push_back(p.say("size_unknown", {{"place", said(place)}}));
  }
}

void Dialogue::answerWhichPlaces(const Utterance&, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  std::vector<Id> named;
  for (const Place& place : places_.map().places) {
    if (!place.words.empty()) named.push_back(place.id);
  }
  const std::size_t count = places_.map().places.size();
  if (count == 0) {
    out.sentences.push_back(p.say("no_map"));
    return;
  }
  if (named.empty()) {
    for (const Place& place : places_.map().places) named.push_back(place.id);
  }
  // The number is that of the list, or the sentence tells both.
  out.sentences.push_back(p.say(named.size() == count ? "places" : "places_named",
                                {{"count", std::to_string(count)},
                                 {"named", std::to_string(named.size())},
                                 {"places", p.list(labels(named))}}));
}

}  // namespace hyselam_topo

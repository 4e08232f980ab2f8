// Answers to questions about the building, from its map. Those that ask for what was told:
// dialogue_told_answers.cpp.
#include <algorithm>
#include <cmath>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/side_angle.hpp"
#include "neighbors.hpp"
#include "way_obstacles.hpp"

namespace hyselam_topo {

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
      const double off = hyselam::normalizeAngle(std::atan2(at.y, at.x) - angleOf(*side));
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

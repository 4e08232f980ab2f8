// Walls that no laser sees, and places that no segmentation finds (section 7.2).
#include <algorithm>
#include <cmath>
#include <limits>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/side_angle.hpp"
#include "way_obstacles.hpp"

namespace hyselam_topo {
namespace {

constexpr double kBeyondDoor = 0.1;  // of a wall that shuts a door, on both sides of it [m]

/// One of each group of places is on one of its sides.
bool leadsToAll(const Edge& edge, const std::vector<std::vector<Id>>& sides) {
  return std::all_of(sides.begin(), sides.end(), [&](const std::vector<Id>& places) {
    return std::any_of(places.begin(), places.end(),
                       [&](Id id) { return id == edge.a || id == edge.b; });
  });
}

/// Shuts a door.
DescribedWall wallAcross(const Door& door) {
  const double half = 0.5 * door.width + kBeyondDoor;
  DescribedWall wall;
  wall.kind = WallKind::kVirtual;
  wall.line.a = {door.position.x - half * door.normal.y, door.position.y + half * door.normal.x};
  wall.line.b = {door.position.x + half * door.normal.y, door.position.y - half * door.normal.x};
  return wall;
}

}  // namespace

void Dialogue::addWall(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  const auto side = sideOf(u.word("side"));
  if (!side || *side == Side::kUnknown) {
    out.sentences.push_back(p.say("cannot_do"));
    return;
  }
  if (!grid_ || !robot().has_pose) {
    out.sentences.push_back(p.say(grid_ ? "at_unknown" : "no_grid"));
    return;
  }
  talk_.questions.drop();
  Question question;
  try {
    // Walls described before are seen: their posts are no corners any more.
    question.search = std::make_shared<GlassWallSearch>(places_.withWalls(*grid_), robot().pose,
                                                        *side, params_.glass);
  } catch (const hyselam::InputError& e) {
    out.sentences.push_back(p.say("not_possible", {{"reason", e.what()}}));
    return;
  }
  question.wall.kind = u.intent == "virtual_wall" ? WallKind::kVirtual : WallKind::kGlass;
  const auto length = u.number("length");
  const auto found = length ? question.search->ofLength(*length) : question.search->likeliest();
  askWall(found, std::move(question), out);
}

void Dialogue::askWall(const std::optional<WallLine>& found, Question question, Reply& out) {
  const Phrases& p = phrases();
  const GlassWallSearch& search = *question.search;
  const std::string& kind = p.wall(question.wall.kind);
  const std::string& side = p.side(search.side());
  if (!found) {
    out.sentences.push_back(p.say("no_corners", {{"side", side}, {"wall", kind}}));
    return;
  }
  const double distance = found->distanceTo({search.robot().x, search.robot().y});
  question.kind = Question::Kind::kWall;
  question.wall.line = *found;
  ask(std::move(question),
      p.say("ask_wall", {{"wall", kind},
                         {"side", side},
                         {"distance", p.number(distance, 2)},
                         {"length", p.number(found->length(), 2)}}),
      out);
}

void Dialogue::forgetWall(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const auto& walls = places_.walls();
  std::optional<std::size_t> chosen;
  const auto side = sideOf(u.word("side"));
  if (side && *side != Side::kUnknown) {
    chosen = wallOnSide(*side);
  } else if (!walls.empty()) {
    chosen = walls.size() - 1;  // the last one that was told
  }
  if (!chosen) {
    out.sentences.push_back(phrases().say("no_wall"));
    return;
  }
  const Change change(this);
  const DescribedWall gone = walls[*chosen];
  places_.removeWall(*chosen);
  out.sentences.push_back(sayWall(gone, false));
  out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

std::optional<std::size_t> Dialogue::wallOnSide(Side side) const {
  if (!robot().has_pose) return std::nullopt;
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  const auto& walls = places_.walls();
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const WallLine& line = walls[i].line;
    const hyselam::Point2 middle{0.5 * (line.a.x + line.b.x), 0.5 * (line.a.y + line.b.y)};
    const hyselam::Point2 seen = robot().pose.inverse() * middle;
    const double off = hyselam::normalizeAngle(std::atan2(seen.y, seen.x) - angleOf(side));
    const double d = std::hypot(seen.x, seen.y);
    if (std::abs(off) > 0.5 * params_.glass.aperture || d > params_.glass.range || d >= least) {
      continue;
    }
    least = d;
    nearest = i;
  }
  return nearest;
}

void Dialogue::addVirtualPlace(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  if (robot().place == 0) {
    out.sentences.push_back(phrases().say(places_.hasMap() ? "no_place_here" : "no_map"));
    return;
  }
  const hyselam::Point2 centre{robot().pose.x, robot().pose.y};
  const auto names = textsOf(u.names("place"));
  if (const auto radius = u.number("radius")) {
    addVirtualAndAsk(centre, *radius, names, out);
    return;
  }
  Question question;
  question.kind = Question::Kind::kRadius;
  question.point = centre;
  question.names = names;
  ask(std::move(question), phrases().say("ask_radius"), out);
}

void Dialogue::addVirtualAndAsk(hyselam::Point2 centre, double radius,
                                const std::vector<std::string>& names, Reply& out) {
  const Phrases& p = phrases();
  const Change change(this);
  Id id = 0;
  try {
    id = places_.addVirtualPlace(centre, radius, names);
  } catch (const hyselam::InputError& e) {
    out.sentences.push_back(p.say("not_possible", {{"reason", e.what()}}));
    return;
  }
  out.sentences.push_back(p.say("virtual_added", {{"code", codeOf(*places_.map().findPlace(id))}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  talk_.subject = id;
  topo_state_.mapChanged(places_.map());
  if (robot().has_pose) topo_state_.update(places_.map(), robot().stamp, robot().pose);
  if (robot().place == id) talk_.asked = id;
  if (names.empty()) askName(id, out);
}

Reply Dialogue::addVirtualPlace(hyselam::Point2 centre, double radius,
                                const std::vector<std::string>& names) {
  Reply out = reply();
  const Change change(this);
  const Id id = places_.addVirtualPlace(centre, radius, names);
  out.sentences.push_back(
      phrases().say("virtual_added", {{"code", codeOf(*places_.map().findPlace(id))}}));
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

std::string Dialogue::sayWall(const DescribedWall& wall, bool is_there) const {
  const Phrases& p = phrases();
  if (places_.doorShutBy(wall) != nullptr) return p.say(is_there ? "door_shut" : "door_open");
  return p.say(is_there ? "wall_added" : "wall_forgotten", {{"wall", p.wall(wall.kind)}});
}

Reply Dialogue::addWall(const DescribedWall& wall) {
  Reply out = reply();
  const Change change(this);
  places_.addWall(wall);
  out.sentences.push_back(sayWall(wall, true));
  haltAtDoor(wall, out);
  out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

Reply Dialogue::removeWall(const DescribedWall& wall) {
  Reply out = reply();
  const Change change(this);
  if (!places_.removeWall(wall)) {
    out.sentences.push_back(phrases().say("no_wall"));
    return out;
  }
  out.sentences.push_back(sayWall(wall, false));
  out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

void Dialogue::openDoor(const DescribedWall& wall, Reply& out) {
  out.sentences.push_back(sayWall(wall, false));
  places_.removeWall(wall);
  out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

std::optional<std::vector<std::vector<Id>>> Dialogue::sidesOfDoor(const Utterance& u, Reply& out) {
  std::vector<std::vector<Id>> sides;
  for (const char* slot : {"place", "other"}) {
    const std::vector<SaidName> names = u.names(slot);
    if (names.empty()) continue;
    sides.push_back(resolve(names.front(), out));
    if (sides.back().empty()) return std::nullopt;
  }
  return sides;
}

void Dialogue::shutDoor(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const auto sides = sidesOfDoor(u, out);
  if (!sides) return;
  struct Found {
    const Edge* edge;
    const Door* door;
  };
  const std::vector<Id> shut = places_.shutDoors();
  std::vector<Found> open, here;  // "here": of the place where the robot and the speaker are
  bool is_shut = false;
  for (const Edge& edge : places_.map().edges) {
    if (!leadsToAll(edge, *sides)) continue;
    for (const Door& door : edge.doors) {
      if (!door.real) continue;
      if (std::find(shut.begin(), shut.end(), door.id) != shut.end()) {
        is_shut = true;
        continue;
      }
      open.push_back({&edge, &door});
      if (edge.a == robot().place || edge.b == robot().place) here.push_back(open.back());
    }
  }
  const Phrases& p = phrases();
  if (open.empty()) {
    out.sentences.push_back(
        is_shut ? p.say("door_shut")
                : p.say("no_door", {{"place", said(u.names("place").front().text)}}));
    return;
  }
  // "The kitchen door", which has more than one.
  if (open.size() > 1 && sides->size() < 2) {
    if (here.size() != 1) {
      const std::vector<Id>& meant = sides->front();
      std::vector<Id> behind;
      for (const Found& each : open) {
        const bool from_a = std::find(meant.begin(), meant.end(), each.edge->a) != meant.end();
        behind.push_back(from_a ? each.edge->b : each.edge->a);
      }
      out.sentences.push_back(p.say("which_door", {{"places", p.list(labels(behind))}}));
      return;
    }
    open = here;
  }
  const Change change(this);
  for (const Found& each : open) {
    const DescribedWall wall = wallAcross(*each.door);
    const std::string sentence = sayWall(wall, true);
    places_.addWall(wall);
    if (each.door == open.front().door) out.sentences.push_back(sentence);
    haltAtDoor(wall, out);
  }
  out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
}

void Dialogue::openDoor(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  const auto sides = sidesOfDoor(u, out);
  if (!sides) return;
  std::vector<DescribedWall> meant;
  for (const DescribedWall& wall : places_.walls()) {
    const Door* door = places_.doorShutBy(wall);
    if (door == nullptr) continue;
    for (const Edge& edge : places_.map().edges) {
      const bool is_of_edge = std::any_of(edge.doors.begin(), edge.doors.end(),
                                          [&](const Door& each) { return &each == door; });
      if (is_of_edge && leadsToAll(edge, *sides)) meant.push_back(wall);
    }
  }
  if (meant.empty()) {
    say("no_shut_door", turn);
    return;
  }
  const Change change(this);
  for (const DescribedWall& wall : meant) openDoor(wall, out);
}

void Dialogue::tellWallInTheWay(const hyselam::Pose2& from, const std::vector<Id>& goals,
                                const std::vector<NamedGoal>& goals_then, Reply& out) {
  const auto found = wallInTheWay(places_, from, goals);
  if (!found) return;
  const Phrases& p = phrases();
  const bool is_door = places_.doorShutBy(found->wall) != nullptr;
  const std::string sentence =
      p.say(is_door ? "shut_in_the_way" : "wall_in_the_way",
            {{"wall", p.wall(found->wall.kind)},
             {"places", p.list({said(shortName(found->a)), said(shortName(found->b))})}});
  if (!is_door) {
    out.sentences.push_back(sentence);
    return;
  }
  Question question;
  question.kind = Question::Kind::kOpenDoor;
  question.wall = found->wall;
  question.goals = goals_then;
  ask(std::move(question), sentence + " " + p.say("ask_open"), out);
}

}  // namespace hyselam_topo

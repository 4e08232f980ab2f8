// What people say, against what they have confirmed on the map.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "neighbors.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

double distanceTo(hyselam::Point2 p, const std::vector<hyselam::Point2>& outline) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    least = std::min(least, distanceToSegment(p, outline[i], outline[(i + 1) % outline.size()]));
  }
  return least;
}

/// Between the outlines of two places that do not overlap [m]; nothing where one is not known.
std::optional<double> gapBetween(const Place& a, const Place& b) {
  if (a.outline.empty() || b.outline.empty()) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  for (const hyselam::Point2& p : a.outline) least = std::min(least, distanceTo(p, b.outline));
  for (const hyselam::Point2& p : b.outline) least = std::min(least, distanceTo(p, a.outline));
  return least;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void Dialogue::nameAsTold(const DescribedBuilding& before) {
  for (const DescribedPlace& place : builder_.building().places) {
    const DescribedPlace* was = before.findPlace(place.id);
    std::vector<std::string> old = was == nullptr ? std::vector<std::string>() : allNamesOf(*was);
    const std::vector<std::string> now = allNamesOf(place);
    if (was == nullptr) {  // told of for the first time: on the map it may have been before
      for (const std::string& name : now) {
        if (!confirmedPlaces(name).empty()) old.push_back(name);
      }
    }
    std::vector<std::string> added, gone;
    std::copy_if(now.begin(), now.end(), std::back_inserter(added), [&](const std::string& name) {
      return !has(old, name) && !isCode(name) && confirmedPlaces(name).empty();
    });
    std::copy_if(old.begin(), old.end(), std::back_inserter(gone),
                 [&](const std::string& name) { return !has(now, name); });
    if (added.empty()) continue;
    std::vector<Id> meant;
    for (const std::string& name : old) {
      for (const Id id : confirmedPlaces(name)) {
        if (std::find(meant.begin(), meant.end(), id) == meant.end()) meant.push_back(id);
      }
    }
    for (const Id id : meant) {
      std::vector<std::string> names = namesOf(*places_.map().findPlace(id));
      names.erase(std::remove_if(names.begin(), names.end(),
                                 [&](const std::string& name) { return has(gone, name); }),
                  names.end());
      names.insert(names.end(), added.begin(), added.end());
      places_.rename(id, names);
    }
  }
}

std::optional<std::string> Dialogue::deniedByMap(const DescribedBuilding& before) const {
  const AugmentedTopologicalMap& map = places_.map();
  const DescribedBuilding& now = builder_.building();
  for (const DescribedPlace& place : now.places) {
    // "The library is also called canteen", and both are confirmed elsewhere.
    const DescribedPlace* was = before.findPlace(place.id);
    const std::vector<std::string> names = allNamesOf(place);
    const std::vector<Id> at = confirmedPlaces(names.front());
    for (const std::string& name : names) {
      if (at.size() != 1 || (was != nullptr && has(allNamesOf(*was), name))) continue;
      const std::vector<Id> other = confirmedPlaces(name);
      if (other.size() != 1 || other == at || areNeighbors(map, at.front(), other.front()))
        continue;
      return phrases().say("is_elsewhere", {{"a", said(names.front())},
                                            {"code_a", codeOf(*map.findPlace(at.front()))},
                                            {"b", said(name)},
                                            {"code_b", codeOf(*map.findPlace(other.front()))}});
    }
  }
  for (const DescribedRelation& relation : now.relations) {
    const bool beside = relation.kind == RelationKind::kNextTo;
    if (!beside && relation.kind != RelationKind::kOpposite) continue;
    const bool known = std::find(before.relations.begin(), before.relations.end(), relation) !=
                       before.relations.end();
    const DescribedPlace *a = now.findPlace(relation.a), *b = now.findPlace(relation.b);
    if (known || relation.denied || a == nullptr || b == nullptr) continue;
    const std::vector<Id> at_a = confirmedPlaces(a->name), at_b = confirmedPlaces(b->name);
    if (at_a.size() != 1 || at_b.size() != 1 || at_a == at_b) continue;
    const Place &place_a = *map.findPlace(at_a.front()), &place_b = *map.findPlace(at_b.front());
    if (areNeighbors(map, place_a.id, place_b.id)) continue;
    if (!beside && haveCommonNeighbor(map, place_a.id, place_b.id)) continue;
    const std::optional<double> gap = gapBetween(place_a, place_b);
    // Neither has the other beside it where a room of their size has its place between them.
    if (!gap || *gap <= std::sqrt(std::max(place_a.area, place_b.area))) continue;
    const Phrases& p = phrases();
    return p.say("far_apart", {{"a", said(a->name)},
                               {"code_a", codeOf(place_a)},
                               {"b", said(b->name)},
                               {"code_b", codeOf(place_b)},
                               {"distance", p.number(*gap, 0)}});
  }
  return std::nullopt;
}

bool Dialogue::askPose(const Utterance& u, Turn& turn) {
  const Place* here = places_.map().findPlace(robot().place);
  const std::vector<SaidName> said_names = u.names("place");
  if (talk_.is_here || here == nullptr || said_names.size() != 1) return false;
  if (!u.word("denied").empty() || !said_names.front().reference.empty()) return false;
  const std::string& name = said_names.front().text;
  const std::vector<Id> found = confirmedPlaces(name);
  if (found.size() != 1 || found.front() == here->id || isCode(name)) return false;
  // Cut into two, a room goes on next door.
  if (places_.map().findEdge(found.front(), here->id) != nullptr) return false;
  if (!placePose(places_.map(), found.front())) return false;
  attempt(turn.reply, [&] { recordStatements(turn); });
  const std::string code = codeOf(*places_.map().findPlace(found.front()));
  const bool named = nameStateOf(*here) == NameState::kConfirmed;
  Question question;
  question.kind = Question::Kind::kPose;
  question.place = found.front();
  question.names = {name};
  question.sentence = turn.text.substr(u.range.begin);
  question.rest = turn.text.substr(std::min(u.range.end, turn.text.size()));
  ask(std::move(question),
      phrases().say("ask_pose", {{"names", said(name)},
                                 {"code", code},
                                 {"here", named ? said(namesOf(*here).front()) : codeOf(*here)}}),
      turn.reply);
  turn.broken_off = true;
  return true;
}

void Dialogue::startFrom(const Question& asked, Turn& turn) {
  const auto pose = placePose(places_.map(), asked.place);
  if (!pose) return;
  DialogueAction action;
  action.kind = DialogueAction::Kind::kPose;
  action.pose = *pose;
  turn.reply.actions.push_back(std::move(action));
  const std::string code = codeOf(*places_.map().findPlace(asked.place));
  turn.reply.sentences.push_back(
      phrases().say("starts_from", {{"code", code}, {"names", said(asked.names.front())}}));
  // It has not gone there: wherever it was before, it was not.
  const double stamp = robot().stamp;
  topo_state_.lost(stamp);
  topo_state_.update(places_.map(), stamp, pose->pose);
  talk_.asked = talk_.subject = asked.place;
  tellRobotPlace(asked.place, namesOf(*places_.map().findPlace(asked.place)));
  const std::size_t more = asked.rest.find_first_not_of(" .,;!?\n\t");
  if (more != std::string::npos) turn.again = asked.rest.substr(more);
}

}  // namespace hyselam_topo

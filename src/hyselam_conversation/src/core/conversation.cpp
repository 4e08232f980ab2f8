#include "hyselam_conversation/conversation.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_language/building/describe_change.hpp"
#include "hyselam_objects/language/answer_text.hpp"
#include "hyselam_objects/language/link_places.hpp"

namespace hyselam_conversation {
namespace {

using hyselam::Pose2;
using hyselam_topo::DialogueAction;
using hyselam_topo::Question;
using hyselam_topo::Reply;

constexpr double kSettled = 10.0;  // the robot has stood long enough to know its place [s]
constexpr double kPerPose = 0.2;   // between the poses of a way [s]

/// As a laser would see it: the cells of places are free, all others occupied.
hyselam::OccupancyGrid gridOf(const hyselam_topo::PlaceGrid& places) {
  hyselam::OccupancyGrid grid;
  grid.geometry = places.geometry;
  grid.cells.reserve(places.labels.size());
  for (const std::uint16_t label : places.labels) {
    grid.cells.push_back(label == 0 ? hyselam::OccupancyGrid::kOccupied
                                    : hyselam::OccupancyGrid::kFree);
  }
  return grid;
}

Layer both(Layer a, Layer b) {
  if (a == Layer::kNone || a == b) return b;
  return b == Layer::kNone ? a : Layer::kBoth;
}

}  // namespace

const char* toString(Motion motion) {
  constexpr std::array<const char*, 3> kNames{"standing", "driving", "following"};
  return kNames.at(static_cast<std::size_t>(motion));
}

const char* toString(Layer layer) {
  constexpr std::array<const char*, 4> kNames{"", "places", "objects", "both"};
  return kNames.at(static_cast<std::size_t>(layer));
}

std::shared_ptr<const Languages> Languages::shipped() {
  std::vector<hyselam_topo::Phrases> phrases;
  for (const std::string& language : hyselam_topo::Phrases::shippedLanguages()) {
    phrases.push_back(hyselam_topo::Phrases::shipped(language));
  }
  return std::make_shared<const Languages>(Languages{hyselam_topo::TopoParser(), std::move(phrases),
                                                     hyselam_objects::ObjectParser::shipped()});
}

std::string Exchange::replyText() const {
  std::string all;
  for (const std::string& sentence : reply) all += (all.empty() ? "" : " ") + sentence;
  return all;
}

Conversation::Conversation(const ConversationParams& params, hyselam_objects::ObjectMap objects,
                           std::shared_ptr<const Languages> languages)
    : params_(params),
      languages_(std::move(languages)),
      dialogue_(params.dialogue, languages_->places, languages_->phrases),
      objects_(std::move(objects)),
      place_names_(languages_->places.grammars()),
      fill_map_(languages_->objects, objects_) {}

// ---- Knowledge from before ----

Exchange Conversation::setMap(const hyselam_topo::AugmentedTopologicalMap& map) {
  Exchange out;
  const Names before = namesNow();
  if (map.grid) dialogue_.setGrid(gridOf(*map.grid));
  take(dialogue_.setMap(map), Layer::kPlaces, out);
  finish(before, out);
  return out;
}

void Conversation::restore(hyselam_topo::DialogueState state) {
  if (state.places.map.grid) dialogue_.setGrid(gridOf(*state.places.map.grid));
  shared_.restore(std::move(state));
  fill_map_.resetContext();
  motion_ = Motion::kStanding;
  ahead_.clear();
  question_.clear();
}

Id Conversation::find(const std::string& place) const {
  const auto found = dialogue_.poseOf(place);
  if (!found) throw hyselam::InputError("place", "", "no place of the map is called " + place);
  return found->first;
}

void Conversation::confirmNames(const std::string& place, const std::vector<std::string>& names) {
  dialogue_.name(find(place), names);
}

void Conversation::guessNames(const std::string& place, const std::vector<std::string>& names) {
  const Id id = find(place);
  hyselam_topo::DialogueState state = dialogue_.state();
  auto& words = state.places.map.findPlace(id)->words;
  words.clear();
  for (const std::string& name : names) words.push_back({name, false});
  dialogue_.restore(std::move(state));
}

std::vector<std::string> Conversation::knownNames() const {
  const std::vector<std::string> places = dialogue_.knownNames();
  std::set<std::string> all(places.begin(), places.end());
  for (const auto& object : objects_.objects) all.insert(object.kind);
  return {all.begin(), all.end()};
}

// ---- The robot ----

Exchange Conversation::stand(const Pose2& pose) {
  Exchange out;
  const Names before = namesNow();
  motion_ = Motion::kStanding;
  ahead_.clear();
  moveTo(pose, kSettled, out);
  finish(before, out);
  return out;
}

Exchange Conversation::standAt(const std::string& place) {
  find(place);  // tells which name is wrong
  return stand(dialogue_.poseOf(place)->second.pose);
}

Exchange Conversation::driveTo(const std::string& place) {
  Exchange out;
  const Names before = namesNow();
  take(dialogue_.goTo(place, {find(place)}), Layer::kPlaces, out);
  if (!out.goal) {
    throw hyselam::InputError("place", "",
                              "there is no way to " + place + ": " + whyNot(place, out));
  }
  finish(before, out);
  return out;
}

std::string Conversation::whyNot(const std::string& place, const Exchange& answer) const {
  if (dialogue_.question().kind == Question::Kind::kGo) {
    const hyselam_topo::Place* guess = dialogue_.map().findPlace(find(place));
    return "no place has this name for sure, " + codeOf(*guess) + " perhaps";
  }
  if (dialogue_.robot().place == find(place)) return "the robot is there already";
  return "the robot says '" + answer.replyText() + "'";
}

Exchange Conversation::arrive() {
  Exchange out;
  const Names before = namesNow();
  const std::vector<Pose2> way = std::move(ahead_);
  ahead_.clear();
  for (const Pose2& pose : way) moveTo(pose, kPerPose, out);
  if (!way.empty()) moveTo(way.back(), kSettled, out);
  motion_ = Motion::kStanding;
  finish(before, out);
  return out;
}

Exchange Conversation::askHere() {
  Exchange out;
  const Names before = namesNow();
  take(dialogue_.askHere(), Layer::kPlaces, out);
  finish(before, out);
  return out;
}

void Conversation::moveTo(const Pose2& pose, double seconds, Exchange& out) {
  take(dialogue_.setPose(time_ += seconds, pose), Layer::kPlaces, out);
}

void Conversation::drive(const std::vector<hyselam_topo::RouteLeg>& legs, Exchange& out) {
  std::vector<Pose2> way;
  for (const hyselam_topo::RouteLeg& leg : legs) {
    way.insert(way.end(), leg.path.begin(), leg.path.end());
  }
  if (way.empty()) return;
  out.goal = legs.back().places.back();
  motion_ = Motion::kDriving;
  const auto middle = way.begin() + static_cast<std::ptrdiff_t>(way.size() / 2);
  ahead_.assign(middle, way.end());
  for (auto pose = way.begin(); pose != middle; ++pose) moveTo(*pose, kPerPose, out);
}

void Conversation::perform(const DialogueAction& action, Exchange& out) {
  switch (action.kind) {
    case DialogueAction::Kind::kMap:
      // As ObjectEngine, which gets the map with the names.
      if (!objects_.places.empty() || !objects_.objects.empty()) {
        linkPlaces(objects_, dialogue_.map(), place_names_);
      }
      break;
    case DialogueAction::Kind::kWalls:
      break;  // they are drawn into the dialogue's own grid
    case DialogueAction::Kind::kGo:
      drive(action.legs, out);
      break;
    case DialogueAction::Kind::kStop:
      out.stopped = true;
      motion_ = Motion::kStanding;
      ahead_.clear();
      break;
    case DialogueAction::Kind::kFollow:
      motion_ = Motion::kFollowing;
      ahead_.clear();
      break;
    case DialogueAction::Kind::kPose:
      motion_ = Motion::kStanding;
      ahead_.clear();
      if (action.pose) moveTo(action.pose->pose, kSettled, out);
      break;
    case DialogueAction::Kind::kTurn: {
      motion_ = Motion::kStanding;
      ahead_.clear();
      const hyselam_topo::RobotPlace& robot = dialogue_.robot();
      if (robot.has_pose) moveTo(robot.pose * Pose2{0.0, 0.0, action.angle}, kSettled, out);
      break;
    }
  }
}

// ---- What is said ----

void Conversation::take(const Reply& reply, Layer layer, Exchange& out) {
  out.language = reply.language;
  out.reply.insert(out.reply.end(), reply.sentences.begin(), reply.sentences.end());
  out.refusals.insert(out.refusals.end(), reply.refusals.begin(), reply.refusals.end());
  if (!reply.sentences.empty()) {
    out.layer = both(out.layer, layer);
    const bool asks = layer == Layer::kObjects ? shared_.objectAskedLast()
                                               : dialogue_.question().kind != Question::Kind::kNone;
    // Questions come last, where they are answered; other sentences may leave one open.
    const std::string& last = reply.sentences.back();
    if (asks && last.find('?') != std::string::npos) question_ = last;
  }
  for (const DialogueAction& action : reply.actions) perform(action, out);
}

void Conversation::askObjects(const hyselam_topo::ForwardedSentence& sentence, Exchange& out) {
  out.forwarded.push_back(sentence.text);
  // Its name may have been told in this very text.
  const hyselam_topo::Place* here = dialogue_.map().findPlace(dialogue_.robot().place);
  const std::vector<std::string> names =
      here == nullptr ? std::vector<std::string>() : namesOf(*here);
  fill_map_.setRobotPlace(names.empty() ? "" : names.front());
  const hyselam_objects::TextAnswer answer =
      answerText(sentence.text, languages_->objects, objects_, dictionary_, fill_map_);
  hyselam_topo::OtherAnswer other;
  other.understood = answer.understood;
  other.about_things = answer.about_things;
  other.reply = answer.text;
  other.reason = answer.reason;
  other.is_question = answer.is_question;
  other.go_to_place = answer.go_to_place;
  for (const hyselam_objects::ObjectPlace& place : answer.places) {
    other.places.push_back({place.name, place.topological});
  }
  const Reply reply = shared_.answered(sentence, &other);
  const bool by_objects =
      answer.understood || std::any_of(reply.refusals.begin(), reply.refusals.end(),
                                       [](const auto& refusal) { return refusal.by_other; });
  if (answer.understood) out.understood.push_back(answer.text);
  take(reply, by_objects ? Layer::kObjects : Layer::kPlaces, out);
}

Exchange Conversation::say(const std::string& text) {
  Exchange out;
  out.text = text;
  const Names before = namesNow();
  const hyselam_topo::DescribedBuilding described = dialogue_.description();
  const Reply reply = shared_.hear(text, true);
  out.utterances = reply.utterances;
  if (reply.ends_other_question) fill_map_.dropQuestion();
  take(reply, Layer::kPlaces, out);
  for (const hyselam_topo::ForwardedSentence& sentence : reply.forwarded) {
    askObjects(sentence, out);
  }
  try {
    const std::vector<std::string> change = hyselam_topo::describeChange(
        described, dialogue_.description(), languages_->places.grammar(out.language));
    out.understood.insert(out.understood.begin(), change.begin(), change.end());
  } catch (const hyselam::InputError&) {
    // A name that cannot be put into words is in the description all the same.
  }
  if (out.goal && params_.arrive_at_once && motion_ == Motion::kDriving) {
    Exchange there = arrive();
    out.reply.insert(out.reply.end(), there.reply.begin(), there.reply.end());
  }
  finish(before, out);
  return out;
}

Conversation::Names Conversation::namesNow() const {
  Names all;
  for (const hyselam_topo::Place& place : dialogue_.map().places) {
    std::string text;
    for (const std::string& name : namesOf(place)) text += (text.empty() ? "" : ", ") + name;
    all[place.id] = {text, nameStateOf(place) == hyselam_topo::NameState::kConfirmed};
  }
  return all;
}

void Conversation::finish(const Names& before, Exchange& out) {
  const Names now = namesNow();
  for (const hyselam_topo::Place& place : dialogue_.map().places) {
    const auto was = before.find(place.id);
    const std::pair<std::string, bool> old =
        was == before.end() ? std::pair<std::string, bool>() : was->second;
    const auto& [name, confirmed] = now.at(place.id);
    if (old.first == name && old.second == confirmed) continue;
    out.names.push_back({place.id, codeOf(place), old.first, name, confirmed});
  }
  const bool open = dialogue_.question().kind != Question::Kind::kNone || shared_.objectAskedLast();
  if (!open) question_.clear();
  out.question = question_;
  out.motion = motion_;
  out.place = dialogue_.robot().place;
}

}  // namespace hyselam_conversation

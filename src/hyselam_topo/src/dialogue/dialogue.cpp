#include "hyselam_topo/dialogue/dialogue.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "dialogue_turn.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace {

std::vector<Phrases> shippedPhrases() {
  std::vector<Phrases> all;
  for (const std::string& language : Phrases::shippedLanguages()) {
    all.push_back(Phrases::shipped(language));
  }
  return all;
}

std::map<std::string, Phrases> byLanguage(std::vector<Phrases> phrases) {
  std::map<std::string, Phrases> all;
  for (Phrases& p : phrases) {
    const std::string language = p.language();
    all.emplace(language, std::move(p));
  }
  return all;
}

}  // namespace

SolverParams DialogueParams::defaultMatch() {
  SolverParams params;
  params.time_limit = 2.0;
  params.keep_within = 0.03;
  return params;
}

void DialogueParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("language", language, "of the robot's first sentences");
  visit("ask", ask,
        {{"never", AskPolicy::kNever},
         {"unconfirmed", AskPolicy::kUnconfirmed},
         {"always", AskPolicy::kAlways}},
        "when the robot asks by itself on entering a place");
  visit("ask_from_afar", ask_from_afar, "also about places where it is not");
  visit("match_time_limit", match.time_limit, Range::between(0.01, 60.0), "s",
        "then the best names found so far are taken");
  visit.group("", state);
  visit.group("glass_", glass, {{"occupied_min", "occupied_min"}});
  visit.group("", route,
              {{"discomfort", visit.kNotOffered},
               {"closed_door", visit.kNotOffered},
               {"spacing", visit.kNotOffered}});
}

void DialogueParams::validate() const {
  hyselam::checkParameters(*this);
  match.validate();
  glass.validate();
}

std::string Reply::text() const {
  std::string all;
  for (const std::string& sentence : sentences) all += (all.empty() ? "" : " ") + sentence;
  return all;
}

bool Reply::has(DialogueAction::Kind kind) const {
  return std::any_of(actions.begin(), actions.end(),
                     [&](const DialogueAction& action) { return action.kind == kind; });
}

void Reply::append(Reply next) {
  const auto move = [](auto& from, auto& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  language = next.language;
  move(next.sentences, sentences);
  move(next.actions, actions);
  move(next.refusals, refusals);
  move(next.utterances, utterances);
}

Dialogue::Dialogue(const DialogueParams& params)
    : Dialogue(params, TopoParser(), shippedPhrases()) {}

Dialogue::Dialogue(const DialogueParams& params, TopoParser parser, std::vector<Phrases> phrases)
    : params_(params),
      parser_(std::move(parser)),
      phrases_(byLanguage(std::move(phrases))),
      language_(params.language),
      names_(parser_.grammars()),
      places_(names_),
      builder_(parser_),
      topo_state_(params.state) {
  params.validate();
  if (phrases_.count(language_) == 0) {
    throw hyselam::ParameterError("language", language_, "one that phrases are there for");
  }
}

const Phrases& Dialogue::phrases() const {
  return phrases_.at(language_);
}

Reply Dialogue::reply() const {
  Reply reply;
  reply.language = language_;
  return reply;
}

// ---- Perception ----

Reply Dialogue::setMap(const AugmentedTopologicalMap& fresh) {
  Reply out = reply();
  const bool first = !places_.hasMap();
  const KnownBefore known = knownNow();
  const std::vector<bool> doors_before = places_.wallsOnDoors();
  const PlaceMan::MapReport report = places_.setMap(fresh);
  if (places_.wallsOnDoors() != doors_before) {
    // What stood in a door that is no longer found is drawn as a wall again.
    out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
  }
  topo_state_.mapChanged(places_.map());
  forgetLost(report.lost, known);
  // What there is to ask of the place is asked with the next pose: the names may change now.
  if (robot().has_pose && topo_state_.update(places_.map(), robot().stamp, robot().pose)) {
    talk_.entered = true;
  }
  if (!builder_.building().places.empty()) matchDescription(out, first);
  tellOutOfSight(report, out);
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

void Dialogue::tellOutOfSight(const PlaceMan::MapReport& report, Reply& out) const {
  const auto tell = [&](const std::string& phrase, std::size_t count) {
    if (count == 0) return;
    out.sentences.push_back(count == 1 ? phrases().say(phrase + "_one")
                                       : phrases().say(phrase, {{"count", std::to_string(count)}}));
  };
  tell("seen_again", report.seen_again.size());
  tell("out_of_sight", report.shelved);
}

void Dialogue::forgetLost(const std::vector<Id>& lost, const KnownBefore& known) {
  // A map of another frame may give their ids to other places.
  const auto isLost = [&](Id id) { return std::find(lost.begin(), lost.end(), id) != lost.end(); };
  const std::vector<Id> asked = placesIn(question());
  if (std::any_of(asked.begin(), asked.end(), isLost)) talk_.questions.drop();
  dropStaleQuestion();
  talk_.changes.forgetPlaces(lost, known);
}

void Dialogue::setGrid(hyselam::OccupancyGrid grid) {
  grid_ = std::make_shared<const hyselam::OccupancyGrid>(std::move(grid));
}

Reply Dialogue::setPose(double stamp, const hyselam::Pose2& pose) {
  Reply out = reply();
  if (topo_state_.update(places_.map(), stamp, pose)) talk_.entered = true;
  seeWhetherArrived();
  const auto isAt = [&](const NamedGoal& goal) {
    return std::find(goal.second.begin(), goal.second.end(), robot().place) != goal.second.end();
  };
  if (talk_.under_way && talk_.way.size() > 1 && isAt(talk_.way.front())) {
    talk_.way.erase(talk_.way.begin());  // there it has been
  }
  if (!talk_.entered) return out;
  talk_.entered = false;
  enterPlace(out);
  return out;
}

Reply Dialogue::losePose(double stamp) {
  topo_state_.lost(stamp);
  return reply();
}

void Dialogue::enterPlace(Reply& out) {
  const Id here = robot().place;
  if (here != talk_.asked) {
    talk_.asked = 0;
    if (question().isAboutName() && question().place != here) leaveQuestion();
  }
  if (here == 0 || robot().in_doorway || here == talk_.asked) return;
  if (!talk_.questions.yields()) return;
  talk_.asked = here;
  askAboutPlace(here, params_.ask, out);
}

Reply Dialogue::askHere() {
  Reply out = reply();
  const Id here = robot().place;
  if (here == 0 || !talk_.questions.yields()) return out;
  askAboutPlace(here, AskPolicy::kAlways, out);
  return out;
}

void Dialogue::askAboutPlace(Id place, AskPolicy policy, Reply& out) {
  switch (askPlace(nameStateOf(*places_.map().findPlace(place)), policy)) {
    case PlaceQuestion::kConfirmName:
      askConfirm(place, out);
      break;
    case PlaceQuestion::kName:
      askName(place, out);
      break;
    case PlaceQuestion::kNothing:
      break;
  }
}

// ---- Knowledge ----

bool Dialogue::useLanguage(const std::string& language) {
  if (phrases_.count(language) == 0) return false;
  language_ = language;
  return true;
}

std::string Dialogue::sayNobodyAnswers() const {
  return phrases().say("nobody_answers");
}

std::optional<hyselam::OccupancyGrid> Dialogue::gridWithWalls() const {
  if (!grid_) return std::nullopt;
  return places_.withWalls(*grid_);
}

std::vector<std::string> Dialogue::knownNames() const {
  std::set<std::string> all;
  for (const Place& place : places_.map().places) {
    for (const PlaceTerm& word : place.words) all.insert(word.text);
  }
  for (const DescribedPlace& place : builder_.building().places) {
    if (!isCode(place.name)) all.insert(place.name);
    all.insert(place.aliases.begin(), place.aliases.end());
  }
  return {all.begin(), all.end()};
}

std::optional<std::pair<Id, PlacePose>> Dialogue::poseOf(const std::string& name) const {
  std::optional<std::pair<Id, PlacePose>> best;
  double least = 0.0;
  for (const Id id : places_.find(name)) {
    const auto pose = placePose(places_.map(), id);
    if (!pose) continue;
    const double d = robot().has_pose ? hyselam::distance(robot().pose, pose->pose) : 0.0;
    if (best && d >= least) continue;
    best = {id, *pose};
    least = d;
  }
  return best;
}

DialogueState Dialogue::state() const {
  return {language_, places_.state(), builder_.building(), heading_, position_, told_at_};
}

void Dialogue::restore(DialogueState state) {
  if (phrases_.count(state.language) == 0) {
    throw hyselam::InputError("state", "language",
                              "there are no phrases for '" + state.language + "'");
  }
  checkDescription(state.description, "state");
  places_.restore(std::move(state.places));
  builder_ = DescriptionBuilder(parser_);
  builder_.continueFrom(std::move(state.description));
  language_ = state.language;
  heading_ = state.heading;
  position_ = state.position;
  told_at_ = places_.map().findPlace(state.told_at) == nullptr ? 0 : state.told_at;
  talk_ = {};
  topo_state_.mapChanged(places_.map());
}

}  // namespace hyselam_topo

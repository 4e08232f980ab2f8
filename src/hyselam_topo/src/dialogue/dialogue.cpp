#include "hyselam_topo/dialogue/dialogue.hpp"

#include <algorithm>
#include <cmath>
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

MatchParams DialogueParams::defaultMatch() {
  MatchParams params;
  params.time_limit = 2.0;
  params.keep_within = 0.03;
  return params;
}

void checkDialogueParams(const DialogueParams& params) {
  checkMatchParams(params.match);
  checkGlassWallParams(params.glass);
  checkRouteParams(params.route);
  checkTopoStateParams(params.state);
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

Dialogue::Dialogue(const DialogueParams& params)
    : Dialogue(params, TopoParser(), shippedPhrases()) {}

Dialogue::Dialogue(const DialogueParams& params, TopoParser parser, std::vector<Phrases> phrases)
    : params_(params),
      parser_(std::move(parser)),
      phrases_(byLanguage(std::move(phrases))),
      language_(params.language),
      places_(PlaceNames(parser_.grammars())),
      builder_(parser_),
      topo_state_(params.state) {
  checkDialogueParams(params);
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

// ---- What the robot perceives ----

Reply Dialogue::setMap(const AugmentedTopologicalMap& fresh) {
  Reply out = reply();
  const bool first = !places_.hasMap();
  places_.setMap(fresh);
  topo_state_.mapChanged(places_.map());
  const bool about_lost_place =
      question_.place != 0 && places_.map().findPlace(question_.place) == nullptr;
  if (about_lost_place) question_ = {};
  // What there is to ask of the place is asked with the next pose: the names may change now.
  if (robot().has_pose && topo_state_.update(places_.map(), robot().stamp, robot().pose)) {
    entered_ = true;
  }
  if (!builder_.building().places.empty()) solve(&out, first);
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  return out;
}

void Dialogue::setGrid(hyselam::OccupancyGrid grid) {
  grid_ = std::move(grid);
}

Reply Dialogue::setPose(double stamp, const hyselam::Pose2& pose) {
  Reply out = reply();
  if (topo_state_.update(places_.map(), stamp, pose)) entered_ = true;
  if (!entered_) return out;
  entered_ = false;
  placeEntered(&out);
  return out;
}

Reply Dialogue::poseLost(double stamp) {
  topo_state_.lost(stamp);
  return reply();
}

/// TopoAskPlace (Alg. 1).
void Dialogue::placeEntered(Reply* out) {
  const Id here = robot().place;
  if (here != asked_) {
    asked_ = 0;
    const bool about_name = question_.kind == Question::Kind::kConfirmName ||
                            question_.kind == Question::Kind::kAlsoName ||
                            question_.kind == Question::Kind::kName;
    // The robot has left the place that it asked about.
    if (about_name && question_.place != here) question_ = {};
  }
  if (here == 0 || robot().in_doorway || here == asked_) return;
  if (question_.kind != Question::Kind::kNone) return;
  asked_ = here;
  const Place& place = *places_.map().findPlace(here);
  const NameState state = nameStateOf(place);
  if (state == NameState::kUnconfirmed && params_.ask != DialogueParams::Ask::kNever) {
    askConfirm(here, out);
  } else if (state == NameState::kNone && params_.ask == DialogueParams::Ask::kAlways) {
    askName(here, out);
  }
}

// ---- What it is told ----

/// That something is in a room: no place that was ever heard of.
bool Dialogue::isOfThing(const Utterance& u) const {
  if (u.intent != "contains") return false;
  const std::vector<std::string> known = knownNames();
  const std::vector<SaidName> names = u.names("places");
  return std::all_of(names.begin(), names.end(), [&](const SaidName& name) {
    if (!name.reference.empty()) return true;
    return places_.find(name.text).empty() &&
           std::none_of(known.begin(), known.end(),
                        [&](const std::string& each) { return places_.sameName(each, name.text); });
  });
}

Reply Dialogue::hear(const std::string& text, const HearOptions& options) {
  ParseOptions parse_options;
  switch (question_.kind) {
    case Question::Kind::kName:
    case Question::Kind::kConfirmName:
      parse_options.expected = {"name_answer"};
      break;
    default:
      break;
  }
  // Answered in the language of the sentence, understood or not: its reason is in that, too.
  parse_options.preferred = language_;
  const ParsedText parsed = parser_.parse(text, parse_options);
  if (phrases_.count(parsed.language) != 0) language_ = parsed.language;
  Turn turn;
  turn.reply = reply();
  std::vector<std::string> not_understood;
  const auto possibly = [&](auto&& act) {
    try {
      act();
    } catch (const hyselam::InputError& e) {
      turn.reply.sentences.push_back(phrases().say("not_possible", {{"reason", e.what()}}));
    }
  };
  std::vector<PassedOn>& passed_on = turn.reply.passed_on;
  // With what stands before it: "No, the pen ...".
  std::size_t end = 0;
  const auto pass = [&](const Utterance& u, const std::string& refusal) {
    const std::size_t begin = std::min(end, u.range.begin);
    const std::string whole = text.substr(begin, std::max(u.range.end, begin) - begin);
    passed_on.push_back({u.correction ? whole : u.text, refusal, u.reason_code == "object"});
  };
  for (const Utterance& u : parsed.utterances) {
    const auto next = [&] { end = std::min(text.size(), u.range.end); };
    if (!u.understood()) {
      const std::string refusal =
          phrases().say("not_understood", {{"text", u.text}, {"reason", u.reason}});
      if (options.pass_on) {
        pass(u, refusal);
      } else {
        not_understood.push_back(refusal);
      }
      next();
      continue;
    }
    const bool for_others = (options.others_asked && u.kind == UtteranceKind::kAnswer) ||
                            (options.of_things && isOfThing(u));
    if (options.pass_on && for_others) {
      pass(u, "");
      next();
      continue;
    }
    if (u.intent != "this_is" && DescriptionBuilder::handles(u.intent)) {
      statement(u, &turn);
      next();
      continue;
    }
    possibly([&] { takeDown(&turn); });
    if (u.intent != "go_to") setOut(&turn);
    Reply& out = turn.reply;
    const std::size_t said = out.sentences.size(), done = out.actions.size(),
                      goals = turn.goals.size();
    out.unknown_name = false;
    possibly([&] {
      if (!understands(u, &turn)) out.sentences.push_back(phrases().say("cannot_do"));
    });
    const bool nothing_done = out.actions.size() == done && turn.goals.size() == goals;
    if (options.pass_on && out.unknown_name && nothing_done && out.sentences.size() == said + 1) {
      pass(u, out.sentences.back());
      out.sentences.pop_back();
    }
    next();
  }
  // All of it: as it was said.
  if (parsed.utterances.size() > 1 && passed_on.size() == parsed.utterances.size() &&
      std::none_of(passed_on.begin(), passed_on.end(),
                   [](const PassedOn& each) { return each.refusal.empty(); })) {
    PassedOn whole{text, "", true};
    for (const PassedOn& each : passed_on) {
      whole.refusal += (whole.refusal.empty() ? "" : " ") + each.refusal;
      whole.of_a_thing = whole.of_a_thing && each.of_a_thing;
    }
    passed_on = {whole};
  }
  possibly([&] { takeDown(&turn); });
  setOut(&turn);
  auto& sentences = turn.reply.sentences;
  // Questions come last, where they are answered.
  const bool asks = question_.kind != Question::Kind::kNone && !sentences.empty();
  sentences.insert(asks ? sentences.end() - 1 : sentences.end(), not_understood.begin(),
                   not_understood.end());
  return turn.reply;
}

bool Dialogue::understands(const Utterance& u, Turn* turn) {
  Reply* out = &turn->reply;
  const std::string& intent = u.intent;
  const auto say = [&](const char* key) { out->sentences.push_back(phrases().say(key)); };
  if (intent == "this_is") {
    thisIs(u, turn);
  } else if (u.kind == UtteranceKind::kAnswer) {
    answer(u, turn);
  } else if (intent == "forget_name") {
    forgetNames(u, turn);
  } else if (intent == "rename") {
    rename(u, turn);
  } else if (intent == "glass_wall") {
    wall(u, WallKind::kGlass, turn);
  } else if (intent == "virtual_wall") {
    wall(u, WallKind::kVirtual, turn);
  } else if (intent == "forget_wall") {
    forgetWall(u, turn);
  } else if (intent == "virtual_place") {
    virtualPlace(u, turn);
  } else if (intent == "go_to") {
    goTo(u, turn);
  } else if (intent == "go_back") {
    if (robot().previous == 0) {
      say("no_previous");
    } else {
      turn->goals.emplace_back(shortName(robot().previous), std::vector<Id>{robot().previous});
    }
  } else if (intent == "follow_me") {
    out->actions.push_back({DialogueAction::Kind::kFollow, {}, 0.0});
    say("following");
  } else if (intent == "stop") {
    question_ = {};
    out->actions.push_back({DialogueAction::Kind::kStop, {}, 0.0});
    say("stopped");
  } else if (intent == "turn") {
    const std::string way = u.word("direction");
    const auto side = sideOf(way);
    if (!side || *side == Side::kUnknown) return false;
    const double angle = *side == Side::kLeft    ? 0.5 * hyselam::kPi
                         : *side == Side::kRight ? -0.5 * hyselam::kPi
                                                 : hyselam::kPi;
    out->actions.push_back({DialogueAction::Kind::kTurn, {}, angle});
    out->sentences.push_back(phrases().say("turning", {{"side", phrases().side(*side)}}));
  } else if (intent == "cancel") {
    question_ = {};
    turn->goals.clear();
    out->actions.push_back({DialogueAction::Kind::kStop, {}, 0.0});
    say("cancelled");
  } else if (intent == "where_are_you") {
    whereAreYou(out);
  } else if (intent == "where_is" || intent == "is_here") {
    whereIs(u, turn);
  } else if (intent == "way_to") {
    wayTo(u, turn);
  } else if (intent == "what_is_next_to") {
    nextTo(u, turn);
  } else if (intent == "what_is_opposite") {
    opposite(u, turn);
  } else if (intent == "what_is_on_side") {
    onSide(u, turn);
  } else if (intent == "what_is_size") {
    size(u, turn);
  } else if (intent == "which_places") {
    whichPlaces(out);
  } else if (intent == "help") {
    say("help");
  } else if (intent == "greeting") {
    say("hello");
  } else if (intent == "thanks") {
    say("welcome");
  } else {
    return false;
  }
  return true;
}

Reply Dialogue::goTo(const std::string& name, const std::vector<Id>& places) {
  Turn turn;
  turn.reply = reply();
  if (places.empty()) {
    turn.reply.sentences.push_back(phrases().say("unknown_place", {{"name", name}}));
    return turn.reply;
  }
  turn.goals.emplace_back(name, places);
  setOut(&turn);
  return turn.reply;
}

// ---- What it knows ----

std::string Dialogue::nobodyAnswers() const {
  return phrases().say("nobody_answers");
}

std::optional<hyselam::OccupancyGrid> Dialogue::gridWithWalls() const {
  if (!grid_) return std::nullopt;
  return places_.withWalls(*grid_);
}

std::vector<std::string> Dialogue::knownNames() const {
  std::set<std::string> all;
  for (const Place& place : places_.map().places) {
    for (const Word& word : place.words) all.insert(word.text);
  }
  for (const DescribedPlace& place : builder_.building().places) {
    all.insert(place.name);
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
  return {language_, places_.state(), builder_.building(), heading_};
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
  question_ = {};
  asked_ = 0;
  subject_ = 0;
  match_.reset();
  topo_state_.mapChanged(places_.map());
}

std::string Dialogue::label(Id id) const {
  const Place& place = *places_.map().findPlace(id);
  const std::string names = phrases().list(namesOf(place));
  switch (nameStateOf(place)) {
    case NameState::kNone:
      return codeOf(place);
    case NameState::kUnconfirmed:
      return codeOf(place) + ", " + phrases().say("perhaps", {{"name", names}});
    case NameState::kConfirmed:
      break;
  }
  return codeOf(place) + ", " + names;
}

std::string Dialogue::shortName(Id id) const {
  const Place& place = *places_.map().findPlace(id);
  return place.words.empty() ? codeOf(place) : namesOf(place).front();
}

std::vector<std::string> Dialogue::labels(const std::vector<Id>& ids) const {
  std::vector<std::string> all;
  for (const Id id : ids) {
    const Place& place = *places_.map().findPlace(id);
    const std::string code = codeOf(place);
    const NameState state = nameStateOf(place);
    if (state == NameState::kNone) {
      all.push_back(code);
      continue;
    }
    std::string label = shortName(id);
    if (state == NameState::kUnconfirmed) label = phrases().say("perhaps", {{"name", label}});
    all.push_back(label.append(" (").append(code).append(")"));
  }
  return all;
}

std::vector<Id> Dialogue::resolve(const SaidName& name, Reply* out) {
  std::vector<Id> found;
  if (name.reference == "here") {
    if (robot().place != 0) found.push_back(robot().place);
    if (found.empty()) out->sentences.push_back(phrases().say("no_place_here"));
  } else if (name.reference == "it") {
    if (subject_ != 0 && places_.map().findPlace(subject_) != nullptr) found.push_back(subject_);
    if (found.empty()) {
      out->sentences.push_back(phrases().say("unknown_place", {{"name", "'" + name.text + "'"}}));
      out->unknown_name = true;
    }
  } else {
    found = places_.find(name.text);
    if (found.empty()) {
      out->sentences.push_back(phrases().say("unknown_place", {{"name", name.text}}));
      out->unknown_name = true;
    }
  }
  if (!found.empty()) subject_ = found.front();
  return found;
}

std::vector<Id> Dialogue::resolve(const Utterance& u, const std::string& slot, Reply* out) {
  const std::vector<SaidName> names = u.names(slot);
  if (names.empty()) {
    SaidName here;
    here.reference = "here";
    return resolve(here, out);
  }
  return resolve(names.front(), out);
}

}  // namespace hyselam_topo

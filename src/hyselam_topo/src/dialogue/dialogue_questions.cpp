// What the robot asks about names, and what is answered to its questions.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"

namespace hyselam_topo {

void Dialogue::askConfirm(Id place, Reply& out) {
  const Place& p = *places_.map().findPlace(place);
  question_ = {};
  question_.kind = Question::Kind::kConfirmName;
  question_.place = place;
  question_.names = namesOf(p);
  out.sentences.push_back(
      phrases().say("ask_confirm", {{"names", phrases().list(question_.names)}}));
}

void Dialogue::askName(Id place, Reply& out) {
  question_ = {};
  question_.kind = Question::Kind::kName;
  question_.place = place;
  out.sentences.push_back(phrases().say("ask_name"));
}

void Dialogue::askAlso(Id place, const std::vector<std::string>& names, Reply& out) {
  const Phrases& p = phrases();
  question_ = {};
  question_.kind = Question::Kind::kAlsoName;
  question_.place = place;
  question_.names = names;
  const std::vector<std::string> known = namesOf(*places_.map().findPlace(place));
  out.sentences.push_back(p.say(
      "ask_also", {{"known", p.list(known)}, {"names", p.list(names)}, {"name", names.front()}}));
}

// Asks the question that best discriminates between near-equal assignments.
void Dialogue::askMostInformativeQuestion(const MatchProblem& problem, Reply& out) {
  constexpr double kWorthAsking = 0.2;  // [bits] that an answer must be worth to bother people
  if (question_.kind != Question::Kind::kNone) return;
  const auto best = mostInformativeQuestion(problem, *match_);
  if (!best || best->bits < kWorthAsking) return;
  const Place& place = *places_.map().findPlace(best->place);
  question_.place = place.id;
  const bool guessed = nameStateOf(place) == NameState::kUnconfirmed;
  question_.kind = guessed ? Question::Kind::kConfirmName : Question::Kind::kName;
  if (guessed) question_.names = namesOf(place);
  out.sentences.push_back(
      guessed ? phrases().say("ask_confirm_there",
                              {{"code", codeOf(place)}, {"names", phrases().list(question_.names)}})
              : phrases().say("ask_name_there", {{"code", codeOf(place)}}));
}

// A guess was wrong: the next one, or the question for the name.
void Dialogue::rejectGuess(Reply& out) {
  const Question asked = question_;
  question_ = {};
  if (places_.map().findPlace(asked.place) == nullptr) return;
  places_.reject(asked.place, asked.names);
  matchDescription(out, false);
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  if (nameStateOf(*places_.map().findPlace(asked.place)) == NameState::kUnconfirmed) {
    askConfirm(asked.place, out);
  } else {
    askName(asked.place, out);
  }
}

void Dialogue::answer(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  if (question_.kind == Question::Kind::kNone) {
    out.sentences.push_back(phrases().say("nothing_asked"));
    return;
  }
  const auto length = u.number("length") ? u.number("length") : u.number("radius");
  if (u.intent == "unknown_answer") {
    question_ = {};
    out.sentences.push_back(phrases().say("cancelled"));
  } else if (u.intent == "name_answer") {
    answerName(textsOf(u.names("place")), out);
  } else if ((u.intent == "length_answer" || u.intent == "radius_answer") && length) {
    answerLength(*length, out);
  } else if (u.intent == "yes") {
    answerYes(out);
  } else if (u.intent == "no") {
    answerNo(out);
  } else {
    out.sentences.push_back(phrases().say("nothing_asked"));
  }
}

void Dialogue::answerName(const std::vector<std::string>& names, Reply& out) {
  const Question asked = question_;
  if (names.empty() || asked.place == 0) return;
  const bool guessed = asked.kind == Question::Kind::kConfirmName;
  const bool as_guessed =
      guessed && std::any_of(asked.names.begin(), asked.names.end(), [&](const std::string& name) {
        return places_.sameName(name, names[0]);
      });
  if (guessed && !as_guessed) places_.reject(asked.place, asked.names);
  confirmNames(asked.place, as_guessed ? asked.names : names, out);
}

void Dialogue::answerLength(double length, Reply& out) {
  if (question_.kind == Question::Kind::kRadius) {
    const Question asked = question_;
    question_ = {};
    addVirtualAndAsk(asked.point, length, asked.names, out);
  } else if (question_.search) {
    askWall(question_.search->ofLength(length), out);
  } else {
    out.sentences.push_back(phrases().say("nothing_asked"));
  }
}

void Dialogue::answerYes(Reply& out) {
  const Question asked = question_;
  switch (asked.kind) {
    case Question::Kind::kConfirmName:
    case Question::Kind::kAlsoName:
      confirmNames(asked.place, asked.names, out);
      break;
    case Question::Kind::kWall:
      question_ = {};
      places_.addWall(asked.wall);
      out.sentences.push_back(
          phrases().say("wall_added", {{"wall", phrases().wall(asked.wall.kind)}}));
      out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
      out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
      break;
    case Question::Kind::kName:
      out.sentences.push_back(phrases().say("ask_name"));  // a name is no matter of yes
      break;
    default:
      out.sentences.push_back(phrases().say("nothing_asked"));
  }
}

void Dialogue::answerNo(Reply& out) {
  const Phrases& p = phrases();
  if (question_.kind == Question::Kind::kConfirmName) {
    rejectGuess(out);
    return;
  }
  if (question_.kind == Question::Kind::kWall) {
    question_.kind = Question::Kind::kWallLength;
    question_.search->reject(question_.wall.line);
    out.sentences.push_back(p.say("ask_wall_length", {{"wall", p.wall(question_.wall.kind)}}));
    return;
  }
  if (question_.kind == Question::Kind::kAlsoName) {
    const Place& place = *places_.map().findPlace(question_.place);
    const std::vector<std::string> names = namesOf(place);
    // What was described from here is told of the place that it is.
    if (builder_.building().robot_place) builder_.setRobotPlace(names.front());
    out.sentences.push_back(p.say("at_named", {{"code", codeOf(place)}, {"names", p.list(names)}}));
  }
  question_ = {};
  out.sentences.push_back(p.say("cancelled"));
}

}  // namespace hyselam_topo

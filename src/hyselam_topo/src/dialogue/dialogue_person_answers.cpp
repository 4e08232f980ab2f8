// What is answered to the robot's questions. One utterance answers one question at most.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "said_answer.hpp"

namespace hyselam_topo {
namespace {

std::vector<std::string> texts(const std::vector<SaidName>& names) {
  std::vector<std::string> all;
  for (const SaidName& name : names) all.push_back(name.text);
  return all;
}

}  // namespace

bool Dialogue::isPlaceName(const SaidName& name) const {
  if (name.quoted || names_.isOfPlace(name.text) ||
      talk_.accepted.count(names_.key(name.text).full) != 0) {
    return true;
  }
  const std::vector<std::string> known = knownNames();
  return std::any_of(known.begin(), known.end(),
                     [&](const std::string& each) { return places_.sameName(each, name.text); });
}

void Dialogue::takeAnswer(const ParsedText& text, Turn& turn) {
  if (takeWhere(text, turn) || !talk_.questions.isOpen()) return;
  SaidAnswer said = answerIn(text, question(), robot().place, [this](const auto& a, const auto& b) {
    return places_.sameName(a, b);
  });
  if (!said.any()) return;
  if (!said.names.empty() && !said.yes && !said.no) heedFirstWord(turn.text, &said);
  turn.used = said.used;
  turn.answered = true;
  // "Yes, no." and "Pardon?": it is put again.
  if (said.repeat || (said.yes && said.no)) {
    turn.reply.sentences.push_back(talk_.questions.sentence());
    return;
  }
  answer(said, turn);
}

/// "Right, that is ...": a word before the first comma that only seems to say nothing.
void Dialogue::heedFirstWord(const std::string& text, SaidAnswer* said) const {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || comma == 0) return;
  ParseOptions options;
  options.preferred = language_;
  const ParsedText first = parser_.parse(text.substr(0, comma), options);
  if (first.utterances.size() != 1) return;
  said->yes = first.utterances.front().intent == "yes";
  said->no = first.utterances.front().intent == "no";
}

void Dialogue::answer(const SaidAnswer& said, Turn& turn) {
  const Question asked = question();
  const Change change(this);
  Reply& out = turn.reply;
  if (!said.names.empty()) {
    answerName(said, asked, out);
    if (asked.kind == Question::Kind::kSpeaker) turn.again = asked.sentence;
  } else if (said.length) {
    answerLength(*said.length, asked, out);
  } else if (said.yes) {
    answerYes(asked, turn);
  } else if (said.no) {
    answerNo(asked, out);
  } else {
    talk_.questions.drop();
    out.sentences.push_back(phrases().say("cancelled"));
  }
}

void Dialogue::answerName(const SaidAnswer& said, const Question& asked, Reply& out) {
  const std::vector<std::string> names = texts(said.names);
  talk_.questions.drop();
  if (asked.kind == Question::Kind::kSpeaker) {
    setSpeaker(names.front(), out);
    return;
  }
  const bool as_asked =
      std::any_of(asked.names.begin(), asked.names.end(),
                  [&](const std::string& name) { return places_.sameName(name, names.front()); });
  if (as_asked && said.no) {  // "No, it is the kitchen", which was asked
    ask(asked, phrases().say("ask_new_name", {{"name", phrases().list(asked.names)}}), out);
    return;
  }
  if (as_asked) {
    confirmNames(asked.place, asked.names, out);
    return;
  }
  // "Right, that is Peter's office": either, never both.
  if (said.yes && asked.kind != Question::Kind::kName) {
    askNewName(asked.place, names, "", out);
    return;
  }
  const bool guessed = asked.kind == Question::Kind::kConfirmName;
  if (!std::all_of(said.names.begin(), said.names.end(),
                   [&](const SaidName& name) { return isPlaceName(name); })) {
    askNewName(asked.place, names, "", out);
  } else if (isNamedOtherwise(asked.place, names)) {
    askAlso(asked.place, names, out);
  } else {
    if (guessed) places_.reject(asked.place, asked.names);
    confirmNames(asked.place, names, out);
  }
}

void Dialogue::answerLength(double length, const Question& asked, Reply& out) {
  talk_.questions.drop();
  if (asked.kind == Question::Kind::kRadius) {
    addVirtualAndAsk(asked.point, length, asked.names, out);
  } else {
    askWall(asked.search->ofLength(length), asked, out);
  }
}

void Dialogue::answerYes(const Question& asked, Turn& turn) {
  Reply& out = turn.reply;
  const Phrases& p = phrases();
  using Kind = Question::Kind;
  // A name or a length is no matter of yes.
  if (asked.kind == Kind::kName || asked.kind == Kind::kRadius || asked.kind == Kind::kWallLength ||
      asked.kind == Kind::kSpeaker) {
    out.sentences.push_back(talk_.questions.sentence());
    return;
  }
  talk_.questions.drop();
  switch (asked.kind) {
    case Kind::kConfirmName:
    case Kind::kAlsoName:
      confirmNames(asked.place, asked.names, out);
      break;
    case Kind::kNewName:
      acceptNames(asked.names);
      if (!asked.sentence.empty()) {
        turn.again = asked.sentence;
      } else if (isNamedOtherwise(asked.place, asked.names)) {
        askAlso(asked.place, asked.names, out);  // a confirmed name does not go unasked
      } else {
        confirmNames(asked.place, asked.names, out);
      }
      break;
    case Kind::kWall:
      places_.addWall(asked.wall);
      out.sentences.push_back(sayWall(asked.wall, true));
      haltAtDoor(asked.wall, out);
      out.actions.push_back({DialogueAction::Kind::kWalls, {}, 0.0});
      out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
      break;
    case Kind::kProposal:
      turn.again = asked.sentence;
      break;
    case Kind::kGo:
      drive(asked.goals, out);
      break;
    case Kind::kOpenDoor:
      openDoor(asked.wall, out);
      if (!asked.goals.empty()) drive(asked.goals, out);
      break;
    case Kind::kPose:
      startFrom(asked, turn);
      break;
    case Kind::kForgetAll:
      forgetEverything(out);
      break;
    default:
      out.sentences.push_back(p.say("cancelled"));
  }
}

void Dialogue::answerNo(const Question& asked, Reply& out) {
  const Phrases& p = phrases();
  talk_.questions.drop();
  switch (asked.kind) {
    case Question::Kind::kConfirmName:
      rejectGuess(asked, out);
      return;
    case Question::Kind::kWall: {
      Question next = asked;
      next.kind = Question::Kind::kWallLength;
      next.search->reject(asked.wall.line);
      const std::string kind = p.wall(asked.wall.kind);
      ask(std::move(next), p.say("ask_wall_length", {{"wall", kind}}), out);
      return;
    }
    case Question::Kind::kAlsoName: {
      const Place& place = *places_.map().findPlace(asked.place);
      const std::vector<std::string> names = namesOf(place);
      // What was described from here is told of the place that it is.
      if (builder_.building().robot_place) tellRobotPlace(place.id, names);
      out.sentences.push_back(
          p.say("at_named", {{"code", codeOf(place)}, {"names", p.list(said(names))}}));
      break;
    }
    case Question::Kind::kMoved: {
      for (const MovedName& each : asked.moved) {
        for (const Id place : each.to) places_.reject(place, {each.name});
      }
      out.sentences.push_back(p.say("cancelled"));
      matchDescription(out, false);
      out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
      return;
    }
    case Question::Kind::kProposal:
      if (!asked.alternatives.empty()) {
        askProposal(asked.alternatives, out);
        return;
      }
      out.sentences.push_back(p.say("say_otherwise"));
      return;
    case Question::Kind::kNewName:
      out.sentences.push_back(p.say("say_otherwise"));
      return;
    case Question::Kind::kPose:
      // Then what was said is the name of the place where it is.
      talk_.is_here = true;
      out.append(understand(asked.sentence, {}));
      talk_.is_here = false;
      return;
    default:
      break;
  }
  out.sentences.push_back(p.say("cancelled"));
}

// A guess was wrong: the next one, or the question for the name.
void Dialogue::rejectGuess(const Question& asked, Reply& out) {
  if (places_.map().findPlace(asked.place) == nullptr) return;
  places_.reject(asked.place, asked.names);
  matchDescription(out, false);
  out.actions.push_back({DialogueAction::Kind::kMap, {}, 0.0});
  const Place& place = *places_.map().findPlace(asked.place);
  const bool guessed = nameStateOf(place) == NameState::kUnconfirmed;
  if (place.id != robot().place && robot().place != 0) {
    askFromAfar(place.id, out);  // "this place" would be another one
  } else if (guessed) {
    askConfirm(place.id, out);
  } else {
    askName(place.id, out);
  }
}

void Dialogue::meetAnswer(const Utterance& u, Turn& turn) {
  Reply& out = turn.reply;
  if (turn.answered) return;  // one utterance answers one question
  turn.answered = true;
  if (u.intent == "repeat" && !talk_.last_said.empty()) {
    out.sentences = talk_.last_said;
  } else if (u.intent == "no" && talk_.under_way) {
    halt(out);
    out.sentences.push_back(phrases().say("stopped"));
  } else if (u.intent == "yes" && askWondered(out)) {
    return;
  } else if (u.intent == "yes" || u.intent == "no" || u.intent == "unknown_answer" ||
             u.intent == "repeat") {
    out.sentences.push_back(phrases().say("cancelled"));
  } else {
    out.sentences.push_back(phrases().say("nothing_asked"));
  }
}

}  // namespace hyselam_topo

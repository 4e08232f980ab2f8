// What the robot asks. What is answered: dialogue_person_answers.cpp.
#include <algorithm>

#include "dialogue_turn.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"

namespace hyselam_topo {

void Dialogue::ask(Question question, const std::string& sentence, Reply& out) {
  talk_.questions.ask(std::move(question), sentence);
  out.sentences.push_back(sentence);
}

void Dialogue::dropStaleQuestion() {
  if (!isStillValid(question(), places_)) talk_.questions.drop();
}

void Dialogue::leaveQuestion() {
  if (question().kind == Question::Kind::kName || !isStillValid(question(), places_)) {
    talk_.questions.drop();
  } else {
    talk_.questions.leave(sayFromAfar(question()));
  }
}

std::string Dialogue::sayFromAfar(const Question& question) const {
  const Phrases& p = phrases();
  const Place& place = *places_.map().findPlace(question.place);
  const std::string names = p.list(said(question.names));
  switch (question.kind) {
    case Question::Kind::kConfirmName:
      return p.say("ask_confirm_there", {{"code", codeOf(place)}, {"names", names}});
    case Question::Kind::kAlsoName:
      return p.say("ask_also_there", {{"code", codeOf(place)},
                                      {"known", p.list(said(namesOf(place)))},
                                      {"names", p.list(question.names)},
                                      {"name", question.names.front()}});
    case Question::Kind::kNewName:
      return p.say("ask_new_name_there", {{"name", p.list(question.names)}});
    default:
      return p.say("ask_name_there", {{"code", codeOf(place)}});
  }
}

void Dialogue::askConfirm(Id place, Reply& out) {
  Question question;
  question.kind = Question::Kind::kConfirmName;
  question.place = place;
  question.names = namesOf(*places_.map().findPlace(place));
  const std::string names = phrases().list(question.names);
  ask(std::move(question), phrases().say("ask_confirm", {{"names", names}}), out);
}

void Dialogue::askName(Id place, Reply& out) {
  Question question;
  question.kind = Question::Kind::kName;
  question.place = place;
  ask(std::move(question), phrases().say("ask_name"), out);
}

void Dialogue::askAlso(Id place, const std::vector<std::string>& names, Reply& out) {
  const Phrases& p = phrases();
  Question question;
  question.kind = Question::Kind::kAlsoName;
  question.place = place;
  question.names = names;
  const std::vector<std::string> known = namesOf(*places_.map().findPlace(place));
  const std::string sentence = place == robot().place
                                   ? p.say("ask_also", {{"known", p.list(said(known))},
                                                        {"names", p.list(names)},
                                                        {"name", names.front()}})
                                   : sayFromAfar(question);
  ask(std::move(question), sentence, out);
}

void Dialogue::askNewName(Id place, const std::vector<std::string>& names,
                          const std::string& sentence, Reply& out) {
  Question question;
  question.kind = Question::Kind::kNewName;
  question.place = place;
  question.names = names;
  question.sentence = sentence;
  const char* key = place == robot().place && place != 0 ? "ask_new_name" : "ask_new_name_there";
  ask(std::move(question), phrases().say(key, {{"name", phrases().list(names)}}), out);
}

void Dialogue::askProposal(const std::vector<std::string>& proposals, Reply& out) {
  Question question;
  question.kind = Question::Kind::kProposal;
  question.sentence = proposals.front();
  question.alternatives.assign(proposals.begin() + 1, proposals.end());
  ask(std::move(question), phrases().say("ask_proposal", {{"suggestion", proposals.front()}}), out);
}

void Dialogue::tellMoved(std::vector<MovedName> moved, bool asks, Reply& out) {
  const Phrases& p = phrases();
  const auto codesOf = [&](const std::vector<Id>& ids) {
    std::vector<std::string> codes;
    for (const Id id : ids) {
      const Place* place = places_.map().findPlace(id);
      if (place != nullptr) codes.push_back(codeOf(*place));
    }
    return p.list(codes);
  };
  std::vector<std::string> lost, told;
  std::vector<MovedName> elsewhere;
  for (MovedName& each : moved) {
    if (each.to.empty()) {
      lost.push_back(each.name);
      continue;
    }
    told.push_back(
        p.say("moved_item",
              {{"name", said(each.name)}, {"from", codesOf(each.from)}, {"to", codesOf(each.to)}}));
    elsewhere.push_back(std::move(each));
  }
  if (!lost.empty()) out.sentences.push_back(p.say("lost_names", {{"names", p.list(said(lost))}}));
  if (elsewhere.empty()) return;
  // One question at a time; what was told to be unsure moves without one.
  const bool any_sure = std::any_of(elsewhere.begin(), elsewhere.end(), [&](const MovedName& each) {
    return talk_.unsure.names.count(each.name) == 0;
  });
  if (!asks || !any_sure || (talk_.questions.isOpen() && talk_.questions.isNew())) {
    out.sentences.push_back(p.say("told_moved", {{"moves", p.list(told)}}));
    return;
  }
  Question question;
  question.kind = Question::Kind::kMoved;
  question.moved = std::move(elsewhere);
  ask(std::move(question), p.say("ask_moved", {{"moves", p.list(told)}}), out);
}

// Asks the question that best discriminates between near-equal assignments.
void Dialogue::askMostInformativeQuestion(const MatchProblem& problem, Reply& out) {
  constexpr double kWorthAsking = 0.2;  // [bits] that an answer must be worth to bother people
  if (talk_.questions.isOpen()) return;
  const auto best = mostInformativeQuestion(problem, *talk_.match);
  if (!best || best->bits < kWorthAsking) return;
  askFromAfar(best->place, out);
}

void Dialogue::askFromAfar(Id id, Reply& out) {
  const Place& place = *places_.map().findPlace(id);
  const bool guessed = nameStateOf(place) == NameState::kUnconfirmed;
  Question question;
  question.place = place.id;
  question.kind = guessed ? Question::Kind::kConfirmName : Question::Kind::kName;
  if (guessed) question.names = namesOf(place);
  const std::string sentence = sayFromAfar(question);
  ask(std::move(question), sentence, out);
}

void Dialogue::settleQuestion(Turn& turn) {
  using Topic = QuestionKeeper::Topic;
  Topic topic = Topic::kNeutral;
  if (turn.answered) {
    topic = Topic::kAnswer;
  } else if (turn.about_else) {
    topic = Topic::kOther;
  } else if (!turn.not_understood.empty() || !turn.reply.forwarded.empty()) {
    topic = Topic::kNotUnderstood;
  }
  const bool again = talk_.questions.endUtterance(topic);
  if (again && turn.reply.forwarded.empty()) {
    turn.reply.sentences.push_back(talk_.questions.sentence());
  }
}

}  // namespace hyselam_topo

#include "hyselam_topo/dialogue/shared_dialogue.hpp"

#include <utility>

namespace hyselam_topo {

void SharedDialogue::restore(DialogueState state) {
  dialogue_.restore(std::move(state));
  objects_spoken_of_ = object_asked_last_ = false;
}

Reply SharedDialogue::hear(const std::string& text, bool others_listen) {
  HearOptions options;
  options.forward_unknown = others_listen;
  options.objects_spoken_of = objects_spoken_of_;
  options.others_asked_last = object_asked_last_;
  Reply reply = dialogue_.hear(text, options);
  const bool asks = dialogue_.question().kind != Question::Kind::kNone && !reply.sentences.empty();
  if (asks || reply.ends_other_question) {
    reply.ends_other_question = reply.ends_other_question || object_asked_last_;
    object_asked_last_ = false;
  }
  if (reply.forwarded.empty()) objects_spoken_of_ = false;
  return reply;
}

Reply SharedDialogue::answered(const ForwardedSentence& sentence, const OtherAnswer* answer) {
  if (answer != nullptr && answer->understood) return carryOut(*answer);
  Reply reply = dialogue_.reply();
  if (sentence.refusal.empty()) {
    reply.append(dialogue_.hear(sentence.text));
  } else {
    const bool by_other = answer != nullptr &&
                          (sentence.about_object || (answer->about_things && !sentence.understood));
    if (by_other) {
      reply.sentences.push_back(answer->reply);
      reply.refusals.push_back({sentence.text, answer->reason, true, ""});
    } else {
      reply.append(dialogue_.refuse(sentence));
    }
  }
  if (answer == nullptr) reply.sentences.push_back(dialogue_.sayNobodyAnswers());
  return reply;
}

Reply SharedDialogue::carryOut(const OtherAnswer& answer) {
  objects_spoken_of_ = true;
  object_asked_last_ = answer.is_question;
  if (!answer.is_question && !answer.go_to_place) dialogue_.thingsSpokenOf();
  Reply reply = dialogue_.reply();
  reply.sentences.push_back(answer.reply);
  if (!answer.go_to_place) return reply;
  const std::vector<Id> goals = goalsOf(answer);
  const std::string name = answer.places.empty() ? "" : answer.places.front().name;
  if (goals.empty() && name.empty()) return reply;  // the answer has told why
  reply.append(dialogue_.goTo(name, goals));
  return reply;
}

std::vector<Id> SharedDialogue::goalsOf(const OtherAnswer& answer) const {
  std::vector<Id> goals;
  for (const OtherAnswer::Goal& each : answer.places) {
    if (each.place != 0 && dialogue_.map().findPlace(each.place) != nullptr) {
      goals.push_back(each.place);
    } else {
      const std::vector<Id> named = dialogue_.places().find(each.name);
      goals.insert(goals.end(), named.begin(), named.end());
    }
  }
  return goals;
}

}  // namespace hyselam_topo

// FillMap: questions to the person and their answers; what people say is gone.
#include <algorithm>
#include <iterator>

#include "hyselam_objects/language/fill_map.hpp"

namespace hyselam_objects {

// ---- Questions to the person ----

ObjectReply FillMap::askBack(const ObjectStatement& statement, const std::string& key,
                             const Values& values, Asked asked) {
  pending_ = Pending{};
  pending_->statement = statement;
  pending_->asked = asked;
  question_is_new_ = true;
  return reply(ReplyKind::kQuestion, key, values);
}

ObjectReply FillMap::askWhich(const ObjectStatement& statement, const ObjectPhrase& phrase,
                              const std::vector<Id>& choices, bool landmark_is_asked,
                              std::size_t object) {
  constexpr std::size_t kMostChoices = 4;  // that anybody can keep in mind
  std::vector<std::string> texts;
  for (const Id id : choices) {
    const std::string where = objectLocation(id);
    const std::string text = objectName(id) + (where.empty() ? "" : " ") + where;
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  const bool told = texts.size() > 1 && texts.size() <= kMostChoices;
  ObjectReply out = askBack(statement, "which_one",
                            {{"count", std::to_string(choices.size())},
                             {"what", phrase.text},
                             {"choices", told ? enumeration(texts, true) : ""}},
                            Asked::kChoice);
  if (!told) {
    out.text = phraseText("which_of_many",
                          {{"count", std::to_string(choices.size())}, {"what", phrase.text}});
  }
  pending_->choices = choices;
  pending_->landmark_is_asked = landmark_is_asked;
  pending_->object = object;
  return out;
}

// ---- Answers ----

std::vector<ObjectReply> FillMap::processAnswer(const ObjectStatement& statement) {
  // "No, no.": the second one does not answer what the first has led to.
  if (question_is_new_) return {};
  if (!pending_) return {reply(ReplyKind::kDone, "nothing_asked")};
  const Pending pending = std::move(*pending_);
  pending_.reset();
  question_is_new_ = true;  // nothing more of this text is an answer
  std::vector<ObjectReply> replies = answerPending(pending, statement);
  const bool done = !replies.empty() && replies.back().kind == ReplyKind::kDone;
  if (pending_) {
    pending_->rest = pending.rest;
  } else if (done && replies.back().code != "kept" && !pending.rest.empty()) {
    for (ObjectReply& each : processAll(pending.rest)) {
      addReply(std::move(each), true, false, &replies);
    }
  }
  return replies;
}

std::vector<ObjectReply> FillMap::answerPending(const Pending& pending,
                                                const ObjectStatement& answer) {
  ObjectStatement again = pending.statement;
  const bool yes = answer.intent == "yes";
  if (answer.intent == "place_answer") {
    again.place = answer.place;
    return {recordObjects(again)};
  }
  if (answer.intent == "choice_answer") {
    const std::vector<Id> chosen = chosenOf(pending, answer);
    if (chosen.size() != 1) {
      const ObjectPhrase& phrase =
          pending.landmark_is_asked ? *again.landmark : again.objects[pending.object];
      return {askWhich(again, phrase, chosen.empty() ? pending.choices : chosen,
                       pending.landmark_is_asked, pending.object)};
    }
    (pending.landmark_is_asked ? *again.landmark : again.objects[pending.object]).chosen = chosen;
    return {processStatement(again)};
  }
  if (pending.asked == Asked::kCount && (yes || answer.count)) {
    constexpr int kSome = 2;  // "some": at least two, and no more are known of
    for (ObjectPhrase& phrase : again.objects) {
      if (!phrase.plural || phrase.has_count || !phrase.reference.empty()) continue;
      phrase.count = answer.count.value_or(kSome);
      phrase.has_count = true;
      break;
    }
    return {recordObjects(again)};
  }
  if (yes && pending.asked == Asked::kProposal) {
    const std::string text = again.suggestion;
    question_is_new_ = false;
    std::vector<ObjectReply> replies = processAll(parser_.parse(text, {}, language_));
    question_is_new_ = true;
    return replies;
  }
  if (pending.asked == Asked::kProposal && answer.intent == "no") {
    if (auto next = proposed(pending.statement, 1)) return {std::move(*next)};
  }
  if (yes && pending.asked == Asked::kYesNo) {
    again.correction = again.moved = true;
    return {record(again)};
  }
  return {reply(ReplyKind::kDone, "kept")};
}

/// "the red one", "the one on the table", "in the kitchen".
std::vector<Id> FillMap::chosenOf(const Pending& pending, const ObjectStatement& answer) const {
  ObjectStatement question = answer;
  Id place = 0;
  if (question.place) {
    place = findPlace(resolvePlaceName(*question.place));
    if (place == 0) return {};
  }
  std::vector<Id> landmarks;
  if (question.landmark) {
    landmarks = candidates(*question.landmark);
    if (landmarks.empty()) return {};
  }
  std::vector<Id> chosen;
  for (const Id id : pending.choices) {
    const ObjectInstance* object = map_.find(id);
    if (object == nullptr) continue;
    if (!question.objects.empty() && question.objects.front().one) {
      question.objects.front().kind = object->kind;
    }
    if (matchesQuestion(*object, question, place, landmarks)) chosen.push_back(id);
  }
  return chosen;
}

// ---- What is gone ----

ObjectReply FillMap::removeObjects(const ObjectStatement& statement) {
  std::vector<Id> all;
  for (std::size_t i = 0; i < statement.objects.size(); ++i) {
    const ObjectPhrase& phrase = statement.objects[i];
    const std::vector<Id> ids = resolveReference(phrase, last_place_);
    if (ids.empty()) {
      if (phrase.reference.empty()) missed_ = phrase;
      return reply(ReplyKind::kQuestion, phrase.reference.empty() ? "unknown" : "no_antecedent",
                   {{"what", phrase.text}});
    }
    if (ids.size() > 1 && !phrase.plural && phrase.reference != "them") {
      return askWhich(statement, phrase, ids, false, i);
    }
    all.insert(all.end(), ids.begin(), ids.end());
  }
  ObjectReply out = reply(ReplyKind::kDone, "forgotten");
  out.facts = factsOf(all, true, "gone");
  if (all.size() == 1) {
    const ObjectInstance& object = *map_.find(all.front());
    missed_ = ObjectPhrase{};
    missed_->kind = missed_->text = object.kind;
    missed_->properties = object.properties;
    missed_->definite = missed_->known_noun = true;
  }
  for (const Id id : all) map_.remove(id);
  last_objects_.clear();
  last_kind_.clear();
  map_.stamp = std::max(map_.stamp, stamp_);
  return out;
}

/// "The pen is no longer on the desk", "there is no toaster in the kitchen": what was known to be
/// there is removed; what is known to be elsewhere stays.
ObjectReply FillMap::removeFromPlace(const ObjectStatement& statement) {
  Id place = 0;
  if (statement.place) {
    const std::string name = resolvePlaceName(*statement.place);
    place = name.empty() ? 0 : findPlace(name);
  }
  std::vector<Id> landmarks;
  if (statement.landmark) {
    landmarks = statement.landmark->reference.empty()
                    ? candidates(*statement.landmark)
                    : resolveReference(*statement.landmark, last_place_);
  }
  std::vector<Id> there;
  const bool nowhere = (statement.place && place == 0) || (statement.landmark && landmarks.empty());
  for (const ObjectInstance& object : map_.objects) {
    if (!nowhere && matchesQuestion(object, statement, place, landmarks)) {
      there.push_back(object.id);
    }
  }
  const ObjectPhrase& phrase = statement.objects.front();
  if (there.empty()) {
    // "The bin is in the hall. It is no longer under the stairs."
    const bool elsewhere = !phrase.reference.empty() && !last_objects_.empty();
    if (elsewhere) return reply(ReplyKind::kDone, "known");
    if (phrase.reference.empty() && candidates(phrase).empty()) {
      missed_ = phrase;
      last_objects_.clear();
    }
    return reply(ReplyKind::kDone, "not_known_there", {{"what", phrase.text}});
  }
  if (there.size() > 1 && !phrase.plural && phrase.definite && phrase.reference != "them") {
    return askWhich(statement, phrase, there, false);
  }
  ObjectStatement gone = statement;
  gone.objects = {phrase};
  gone.objects.front().chosen = there;
  gone.objects.front().plural = true;
  return removeObjects(gone);
}

}  // namespace hyselam_objects

#include "hyselam_objects/language/fill_map.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>

#include "hyselam_language/grammar/near_example.hpp"
#include "hyselam_language/grammar/words_left_out.hpp"

namespace hyselam_objects {

using hyselam_topo::UtteranceKind;

const char* toString(ReplyKind kind) {
  constexpr std::array<const char*, 4> kNames{"done", "answer", "question", "not understood"};
  return kNames.at(static_cast<std::size_t>(kind));
}

FillMap::FillMap(const ObjectParser& parser, ObjectMap& map) : parser_(parser), map_(map) {}

std::vector<ObjectReply> FillMap::process(const std::string& text) {
  forgetGone();
  question_is_new_ = false;
  std::set<std::string> expected;
  if (pending_ && pending_->asked == Asked::kPlace) expected.insert("place_answer");
  if (pending_ && pending_->asked == Asked::kCount) expected.insert("count_answer");
  if (pending_ && pending_->asked == Asked::kChoice) expected.insert("choice_answer");
  return processAll(parser_.parse(text, expected, language_));
}

/// The detector may have merged or removed some objects in the meantime. A question which of them
/// is meant is over with the last of them; other phrases that mean them look for others
/// (candidates()).
void FillMap::forgetGone() {
  last_objects_ = stillThere(last_objects_);
  landmarks_told_ = stillThere(landmarks_told_);
  last_added_ = stillThere(last_added_);
  if (!pending_ || pending_->asked != Asked::kChoice) return;
  pending_->choices = stillThere(pending_->choices);
  if (pending_->choices.empty()) pending_.reset();
}

std::vector<Id> FillMap::stillThere(const std::vector<Id>& objects) const {
  std::vector<Id> left;
  std::copy_if(objects.begin(), objects.end(), std::back_inserter(left),
               [this](Id id) { return map_.find(id) != nullptr; });
  return left;
}

/// What a sentence goes on with waits if its beginning leads to a question. Words that were left
/// out beside statements are told.
std::vector<ObjectReply> FillMap::processAll(const std::vector<ObjectStatement>& statements) {
  std::vector<ObjectReply> replies;
  for (std::size_t i = 0; i < statements.size(); ++i) {
    for (ObjectReply& each : processOne(statements[i])) {
      const bool same =
          !statements[i].objects.empty() && statements[i].objects.front().reference == "same";
      addReply(std::move(each), statements[i].continues, same, &replies);
    }
    const bool done = replies.empty() || replies.back().kind == ReplyKind::kDone;
    for (; !done && i + 1 < statements.size() && statements[i + 1].continues; ++i) {
      if (pending_) pending_->rest.push_back(statements[i + 1]);
    }
  }
  for (ObjectReply& each : replies) {
    if (each.facts.empty()) continue;
    std::string all;
    for (const std::string& fact : each.facts) all += (all.empty() ? "" : "; ") + fact;
    each.text = phraseText("done", {{"what", all}});
  }
  std::vector<std::string> all_left_out;
  for (const ObjectStatement& each : statements) {
    if (each.kind != UtteranceKind::kStatement) continue;
    all_left_out.insert(all_left_out.end(), each.left_out.begin(), each.left_out.end());
  }
  // Each once: one sentence may tell several things.
  const std::string left_out = hyselam_topo::quotedInARow(all_left_out);
  if (!left_out.empty() && !replies.empty()) {
    const std::string told = phraseText("left_out", {{"text", left_out}});
    std::string& text = replies.back().text;
    text = replies.back().kind == ReplyKind::kQuestion ? told + " " + text : text + " " + told;
  }
  return replies;
}

/// Parts of one sentence are told together.
void FillMap::addReply(ObjectReply reply, bool continues, bool replaces,
                       std::vector<ObjectReply>* replies) {
  const bool together = continues && !replies->empty() && reply.kind == ReplyKind::kDone &&
                        replies->back().kind == ReplyKind::kDone;
  if (!together) {
    replies->push_back(std::move(reply));
    return;
  }
  ObjectReply& whole = replies->back();
  if (whole.facts.empty() && reply.facts.empty()) return;
  if (whole.facts.empty()) whole.code = reply.code;
  if (replaces && !reply.facts.empty() && !whole.facts.empty()) whole.facts.pop_back();
  whole.facts.insert(whole.facts.end(), reply.facts.begin(), reply.facts.end());
  whole.objects = reply.objects;
  whole.places = reply.places;
}

std::vector<ObjectReply> FillMap::processOne(const ObjectStatement& statement) {
  language_ = statement.language;
  if (statement.kind == UtteranceKind::kAnswer) return processAnswer(statement);
  if (statement.kind == UtteranceKind::kNotUnderstood) return {refuse(statement)};
  if (!question_is_new_) pending_.reset();
  return {processStatement(statement)};
}

/// Whether a proposed sentence is understood, as a whole, and tells of no name without a noun.
bool FillMap::isWhole(const std::string& sentence) const {
  const auto statements = parser_.parse(sentence, {}, language_);
  return std::all_of(statements.begin(), statements.end(), [](const ObjectStatement& each) {
    const auto isNamed = [](const ObjectPhrase& phrase) {
      return phrase.known_noun || !phrase.reference.empty() || !phrase.bare;
    };
    return each.kind != UtteranceKind::kNotUnderstood && each.intent != "that_one" &&
           !each.objects.empty() &&
           std::all_of(each.objects.begin(), each.objects.end(), isNamed) &&
           (!each.landmark || isNamed(*each.landmark));
  });
}

std::optional<ObjectReply> FillMap::proposed(const ObjectStatement& statement, std::size_t from) {
  std::vector<std::string> all{statement.suggestion};
  all.insert(all.end(), statement.alternatives.begin(), statement.alternatives.end());
  for (std::size_t i = from; i < all.size(); ++i) {
    if (!isWhole(all[i])) continue;
    ObjectStatement asked = statement;
    asked.suggestion = all[i];
    asked.alternatives.assign(all.begin() + static_cast<std::ptrdiff_t>(i) + 1, all.end());
    ObjectReply question = askBack(asked, "proposal", {{"suggestion", all[i]}}, Asked::kProposal);
    // Who says yes must know what the proposal does without.
    const std::string left_out = hyselam_topo::quotedInARow(
        hyselam_topo::wordsLeftOut(statement.text, all[i], parser_.grammar(language_)));
    if (!left_out.empty()) {
      question.text = phraseText("left_out", {{"text", left_out}}) + " " + question.text;
    }
    return question;
  }
  return std::nullopt;
}

/// A question stays for one text that was not understood: it may have been the answer.
ObjectReply FillMap::refuse(const ObjectStatement& statement) {
  if (pending_ && !question_is_new_ && ++pending_->failures > 1) pending_.reset();
  last_objects_.clear();
  last_kind_.clear();
  last_statement_.reset();
  last_question_.reset();
  missed_.reset();
  const Values values{
      {"text", statement.text}, {"reason", statement.reason}, {"suggestion", statement.suggestion}};
  const hyselam_topo::Grammar& grammar = parser_.grammar(language_);
  // Words that make a sentence uncertain are not to be left out.
  const std::string own = "instead_" + statement.reason_code;
  const bool proposes =
      statement.suggests_meaning && !statement.suggestion.empty() && !grammar.has(own);
  if (proposes && !question_is_new_) {
    if (auto asked = proposed(statement, 0)) return *std::move(asked);
  }
  ObjectReply out = reply(ReplyKind::kNotUnderstood, "not_understood", values);
  out.reason = statement.reason;
  if (grammar.has(own) && !statement.suggests_own_words) {
    out.text += " " + phraseText("instead", {{"suggestion", phraseText(own)}});
  } else if (!statement.suggestion.empty() &&
             (statement.suggests_own_words || statement.suggests_meaning ||
              hyselam_topo::isNearExample(statement.text, statement.suggestion, grammar))) {
    out.text += " " + phraseText("instead", values);
  }
  return out;
}

ObjectReply FillMap::processStatement(const ObjectStatement& said) {
  ObjectStatement statement = said;
  if (!resolveOnes(&statement)) {
    return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", statement.text}});
  }
  if (statement.intent == "that_one") return describeLast(statement);
  last_question_.reset();
  takeMissed(&statement);
  if (statement.kind == UtteranceKind::kQuestion || statement.intent == "go_to") {
    return answerQuestion(statement);
  }
  const std::string what = statement.objects.empty() ? "" : statement.objects.front().text;
  if (statement.intent == "cannot") return reply(ReplyKind::kAnswer, "cannot", {{"what", what}});
  if (statement.intent == "pointing") {
    return reply(ReplyKind::kQuestion, "pointing", {{"what", what}});
  }
  if (statement.intent == "forget_object") return removeObjects(statement);
  if (statement.intent == "not_there") return removeFromPlace(statement);
  if (statement.intent == "this_is") {
    const std::string& kind = statement.objects.front().kind;
    ObjectReply out =
        reply(ReplyKind::kDone, "shown", {{"what", formed("a", kind, {{"what", kind}})}});
    out.kind_of_object = kind;
    return out;
  }
  if (statement.intent == "same_where" || statement.intent == "same_what" ||
      statement.intent == "same_like") {
    return correctLast(statement);
  }
  return record(statement);
}

/// "Somebody has taken the ladder. It is in the hall."
void FillMap::takeMissed(ObjectStatement* statement) {
  const std::optional<ObjectPhrase> missed = std::move(missed_);
  missed_.reset();
  if (!missed || !last_objects_.empty() || statement->objects.size() != 1) return;
  ObjectPhrase& phrase = statement->objects.front();
  if (phrase.reference == "it" || phrase.reference == "them") phrase = *missed;
}

/// "The yellow one.", of what was told or asked for last.
ObjectReply FillMap::describeLast(const ObjectStatement& said) {
  if (last_question_ && !last_question_->objects.empty()) {
    ObjectStatement question = *last_question_;
    for (const auto& [key, value] : said.properties) {
      question.objects.front().properties[key] = value;
    }
    question.objects.front().definite = true;
    return answerQuestion(question);
  }
  if (last_objects_.empty()) {
    return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", said.text}});
  }
  ObjectStatement statement = said;
  statement.intent = "is_like";
  return recordProperties(statement);
}

/// "No, under the table.", "Sorry, two cups.", "No, blue."
ObjectReply FillMap::correctLast(const ObjectStatement& said) {
  ObjectStatement statement = said;
  if (last_objects_.empty() || (said.intent == "same_what" && !last_statement_)) {
    return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", said.text}});
  }
  if (said.intent == "same_like") return recordProperties(statement);
  if (said.intent == "same_where") {
    statement.intent = "is_at";
    return recordObjects(statement);
  }
  const ObjectPhrase& phrase = said.objects.front();
  ObjectStatement again = *last_statement_;
  again.correction = again.moved = true;
  if (again.objects.empty() || again.objects.front().reference == "same") {
    return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", said.text}});
  }
  if (phrase.kind == last_kind_ && phrase.has_count) {
    again.objects = said.objects;
    return recordObjects(again);
  }
  for (const Id id : last_added_) {
    if (std::find(last_objects_.begin(), last_objects_.end(), id) != last_objects_.end()) {
      map_.remove(id);
    }
  }
  last_objects_.clear();
  again.objects = said.objects;
  ObjectReply out = recordObjects(again);
  return out;
}

ObjectReply FillMap::record(const ObjectStatement& statement) {
  if (statement.intent == "is_like") return recordProperties(statement);
  if (statement.intent == "is_owned") return recordOwner(statement);
  return recordObjects(statement);
}

/// "the green one": of the kind of the object that lies there, or mentioned last.
bool FillMap::resolveOnes(ObjectStatement* statement) const {
  const auto resolve = [this](ObjectPhrase& phrase, const std::string& kind) {
    if (!phrase.one) return true;
    if (kind.empty()) return false;
    // "a vermelha" is no cup
    const std::string here = parser_.kindIn(language_, kind);
    if (!phrase.form.empty() && !parser_.mayHaveForm(language_, here, phrase.form)) return false;
    phrase.kind = kind;
    return true;
  };
  for (ObjectPhrase& phrase : statement->objects) {
    if (!resolve(phrase, last_kind_)) return false;
  }
  if (!statement->landmark) return true;
  const bool named = !statement->objects.empty() && !statement->objects.front().kind.empty();
  return resolve(*statement->landmark, named ? statement->objects.front().kind : last_kind_);
}

// ---- Properties ----

ObjectReply FillMap::recordOwner(const ObjectStatement& statement) {
  return recordProperties(statement);
}

ObjectReply FillMap::recordProperties(const ObjectStatement& statement) {
  std::map<std::string, std::string> properties = statement.properties;
  if (!statement.owner.empty()) properties["owner"] = statement.owner;
  std::vector<Id> all;
  for (std::size_t i = 0; i < statement.objects.size(); ++i) {
    const ObjectPhrase& phrase = statement.objects[i];
    std::vector<Id> ids = resolveReference(phrase, last_place_);
    if (phrase.reference == "one_of_them" && !ids.empty()) {
      // One that is not known to be otherwise.
      const auto fits = [&](Id id) {
        return std::none_of(properties.begin(), properties.end(), [&](const auto& wanted) {
          const auto& known = map_.find(id)->properties;
          return known.count(wanted.first) != 0;
        });
      };
      const auto one = std::find_if(ids.begin(), ids.end(), fits);
      ids = {one == ids.end() ? ids.front() : *one};
    }
    if (ids.empty()) {
      return reply(ReplyKind::kQuestion, phrase.reference.empty() ? "unknown" : "no_antecedent",
                   {{"what", phrase.text}});
    }
    const bool many = phrase.plural || phrase.reference == "them" || phrase.reference == "same";
    if (!many && ids.size() > 1) return askWhich(statement, phrase, ids, false, i);
    all.insert(all.end(), ids.begin(), ids.end());
  }
  return setProperties(statement, all, properties);
}

ObjectReply FillMap::setProperties(const ObjectStatement& statement, const std::vector<Id>& objects,
                                   const std::map<std::string, std::string>& properties) {
  for (const Id id : objects) {
    for (const auto& [key, value] : properties) {
      const auto& known = map_.find(id)->properties;
      const auto found = known.find(key);
      if (found != known.end() && found->second != value && !statement.correction) {
        const auto facts = factsOf({id}, true);
        return askBack(statement, "contradiction",
                       {{"known", facts.front()}, {"said", statement.text}});
      }
    }
  }
  for (const Id id : objects) {
    for (const auto& [key, value] : properties) map_.find(id)->properties[key] = value;
  }
  last_objects_ = objects;
  last_kind_ = map_.find(objects.front())->kind;
  map_.stamp = std::max(map_.stamp, stamp_);
  ObjectReply out = reply(ReplyKind::kDone, "done");
  out.facts = factsOf(objects, true);
  out.objects = objects;
  return out;
}

void FillMap::setRobotPlace(const std::string& name) {
  if (name != robot_place_) last_place_ = 0;
  robot_place_ = name;
  if (name.empty()) return;  // a doorway, or a place without a name
  if (name != last_named_place_) just_came_ = !last_named_place_.empty();
  last_named_place_ = name;
}

void FillMap::resetContext() {
  last_objects_.clear();
  landmarks_told_.clear();
  last_added_.clear();
  last_landmark_ = last_place_ = 0;
  just_came_ = false;
  last_kind_.clear();
  last_statement_.reset();
  last_question_.reset();
  missed_.reset();
  question_is_new_ = false;
  pending_.reset();
}

}  // namespace hyselam_objects

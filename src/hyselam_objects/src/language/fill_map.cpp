#include "hyselam_objects/language/fill_map.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace hyselam_objects {

using hyselam_topo::UtteranceKind;

const char* toString(ReplyKind kind) {
  constexpr std::array<const char*, 4> kNames{"done", "answer", "question", "not understood"};
  return kNames.at(static_cast<std::size_t>(kind));
}

FillMap::FillMap(const ObjectParser& parser, ObjectMap& map) : parser_(parser), map_(map) {}

std::vector<ObjectReply> FillMap::process(const std::string& text) {
  // The detector may have merged or removed some objects in the meantime.
  last_objects_.erase(std::remove_if(last_objects_.begin(), last_objects_.end(),
                                     [this](Id id) { return map_.find(id) == nullptr; }),
                      last_objects_.end());
  std::set<std::string> expected;
  if (pending_ && pending_->for_place) expected.insert("place_answer");
  if (pending_ && pending_->for_count) expected.insert("count_answer");
  std::vector<ObjectReply> replies;
  for (const ObjectStatement& statement : parser_.parse(text, expected, language_)) {
    replies.push_back(processStatement(statement));
  }
  return replies;
}

ObjectReply FillMap::processStatement(const ObjectStatement& statement) {
  language_ = statement.language;
  switch (statement.kind) {
    case UtteranceKind::kNotUnderstood: {
      ObjectReply out = reply(ReplyKind::kNotUnderstood, "not_understood",
                              {{"text", statement.text}, {"reason", statement.reason}});
      out.reason = statement.reason;
      return out;
    }
    case UtteranceKind::kAnswer:
      return processAnswer(statement);
    case UtteranceKind::kQuestion:
      return answerQuestion(statement);
    default:
      break;
  }
  pending_.reset();
  if (statement.intent == "go_to") return answerQuestion(statement);
  if (statement.intent == "forget_object") return removeObjects(statement);
  if (statement.intent == "this_is") {
    const std::string& kind = statement.objects.front().kind;
    ObjectReply out = reply(ReplyKind::kDone, "shown", {{"what", kind}});
    out.kind_of_object = kind;
    return out;
  }
  if (statement.intent == "is_like") return recordProperties(statement);
  return recordObjects(statement);
}

ObjectReply FillMap::recordProperties(const ObjectStatement& statement) {
  std::vector<Id> all;
  for (const ObjectPhrase& phrase : statement.objects) {
    const std::vector<Id> ids = resolveReference(phrase, last_place_);
    if (ids.empty()) {
      return reply(ReplyKind::kQuestion, phrase.reference.empty() ? "unknown" : "no_antecedent",
                   {{"what", phrase.text}});
    }
    const bool many = phrase.plural || phrase.reference == "them";
    if (!many && ids.size() > 1) {
      return askBack(statement, "which_one",
                     {{"count", std::to_string(ids.size())}, {"what", phrase.text}});
    }
    all.insert(all.end(), ids.begin(), ids.end());
  }
  for (const Id id : all) {
    for (const auto& [key, value] : statement.properties) {
      const auto& known = map_.find(id)->properties;
      const auto found = known.find(key);
      if (found != known.end() && found->second != value && !statement.correction) {
        return askBack(
            statement, "contradiction",
            {{"known", objectName(id) + " " + objectLocation(id)}, {"said", statement.text}});
      }
    }
  }
  std::vector<std::string> names;
  for (const Id id : all) {
    for (const auto& [key, value] : statement.properties) map_.find(id)->properties[key] = value;
    names.push_back(objectName(id));
  }
  last_objects_ = all;
  map_.stamp = std::max(map_.stamp, stamp_);
  ObjectReply out = reply(ReplyKind::kDone, "done", {{"what", enumeration(names)}});
  out.objects = all;
  return out;
}

ObjectReply FillMap::removeObjects(const ObjectStatement& statement) {
  std::vector<Id> all;
  std::vector<std::string> names;
  for (const ObjectPhrase& phrase : statement.objects) {
    const std::vector<Id> ids = resolveReference(phrase, last_place_);
    if (ids.empty()) return reply(ReplyKind::kQuestion, "unknown", {{"what", phrase.text}});
    if (ids.size() > 1 && !phrase.plural && phrase.reference != "them") {
      return askBack(statement, "which_one",
                     {{"count", std::to_string(ids.size())}, {"what", phrase.text}});
    }
    all.insert(all.end(), ids.begin(), ids.end());
  }
  for (const Id id : all) {
    names.push_back(objectName(id));
    map_.remove(id);
  }
  last_objects_.clear();
  map_.stamp = std::max(map_.stamp, stamp_);
  return reply(ReplyKind::kDone, "forgotten", {{"what", enumeration(names)}});
}

ObjectReply FillMap::processAnswer(const ObjectStatement& statement) {
  if (!pending_) return reply(ReplyKind::kDone, "nothing_asked");
  const Pending pending = std::move(*pending_);
  pending_.reset();
  ObjectStatement again = pending.statement;
  if (statement.intent == "place_answer") {
    again.place = statement.place;
    return recordObjects(again);
  }
  if (pending.for_count && (statement.intent == "yes" || statement.count)) {
    constexpr int kSome = 2;  // "some": at least two, and no more are known of
    for (ObjectPhrase& phrase : again.objects) {
      if (!phrase.plural || phrase.has_count || !phrase.reference.empty()) continue;
      phrase.count = statement.count.value_or(kSome);
      phrase.has_count = true;
      break;
    }
    return recordObjects(again);
  }
  if (statement.intent == "yes" && !pending.for_place) {
    again.correction = true;
    return again.intent == "is_like" ? recordProperties(again) : recordObjects(again);
  }
  return reply(ReplyKind::kDone, "kept");
}

void FillMap::resetContext() {
  last_objects_.clear();
  last_place_ = 0;
  pending_.reset();
}

}  // namespace hyselam_objects

// FillMap: answers to questions about the map, and the words of all replies.
#include <algorithm>
#include <set>

#include "hyselam_objects/language/fill_map.hpp"

namespace hyselam_objects {
namespace {

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& each : sentences) text += (text.empty() ? "" : " ") + each;
  return text;
}

}  // namespace

// ---- Questions ----

ObjectReply FillMap::answerQuestion(const ObjectStatement& question) {
  Id place = 0;
  if (question.place) {
    const std::string name = resolvePlaceName(*question.place);
    place = name.empty() ? 0 : findPlace(name);
    if (place == 0) return reply(ReplyKind::kAnswer, "nothing");
  }
  std::vector<Id> landmarks;
  if (question.landmark) {
    landmarks = question.landmark->reference.empty()
                    ? candidates(*question.landmark)
                    : resolveReference(*question.landmark, last_place_);
    if (landmarks.empty()) {
      return reply(ReplyKind::kAnswer, "unknown", {{"what", question.landmark->text}});
    }
  }
  std::vector<Id> objects;
  std::set<Id> places;
  for (const ObjectInstance& object : map_.objects) {
    if (!matchesQuestion(object, question, place, landmarks)) continue;
    objects.push_back(object.id);
    if (map_.placeOf(object.id) != 0) places.insert(map_.placeOf(object.id));
  }
  const std::vector<Id> all_places(places.begin(), places.end());
  ObjectReply out = answerText(question, objects, all_places);
  out.objects = objects;
  out.places = all_places;
  return out;
}

bool FillMap::matchesQuestion(const ObjectInstance& object, const ObjectStatement& question,
                              Id place, const std::vector<Id>& landmarks) const {
  const auto isIn = [](Id id, const std::vector<Id>& ids) {
    return std::find(ids.begin(), ids.end(), id) != ids.end();
  };
  if (!question.objects.empty()) {
    const ObjectPhrase& phrase = question.objects.front();
    const bool meant =
        phrase.reference.empty() ? matchesPhrase(object, phrase) : isIn(object.id, last_objects_);
    if (!meant) return false;
  }
  if (place != 0 && map_.placeOf(object.id) != place) return false;
  if (!question.landmark) return true;
  const auto carried = [](RelationWord word) {
    return isSupport(word) && word != RelationWord::kUnder;
  };
  for (const ObjectRelation* r : map_.relationsOf(object.id)) {
    if (!isIn(r->other, landmarks)) continue;
    // "on the table" asks for what is over it or in it, too.
    if (r->word == *question.relation || (carried(*question.relation) && carried(r->word))) {
      return true;
    }
  }
  return false;
}

ObjectReply FillMap::answerText(const ObjectStatement& question, const std::vector<Id>& objects,
                                const std::vector<Id>& places) const {
  if (question.intent == "how_many") {
    return reply(ReplyKind::kAnswer, "how_many_answer",
                 {{"count", std::to_string(objects.size())}});
  }
  if (question.intent == "is_there") return isThereAnswer(objects);
  if (objects.empty()) {
    return question.objects.empty()
               ? reply(ReplyKind::kAnswer, "nothing")
               : reply(ReplyKind::kAnswer, "unknown", {{"what", question.objects.front().text}});
  }
  if (question.intent == "which_rooms") {
    return reply(ReplyKind::kAnswer, "rooms", {{"places", placeNames(places)}});
  }
  if (question.intent == "go_to") return goToAnswer(objects, places);
  std::vector<std::string> items;
  if (question.intent == "where_is") {
    for (const Id id : objects) {
      items.push_back(
          phraseText("where", {{"what", objectName(id)}, {"where", objectLocation(id)}}));
    }
    ObjectReply out = reply(ReplyKind::kAnswer, "where");
    out.text = joined(items);
    return out;
  }
  for (const Id id : objects) items.push_back(objectName(id));
  return reply(ReplyKind::kAnswer, "what", {{"what", enumeration(items)}});
}

ObjectReply FillMap::isThereAnswer(const std::vector<Id>& objects) const {
  if (objects.empty()) return reply(ReplyKind::kAnswer, "not_there");
  std::vector<std::string> sentences;
  for (const Id id : objects) {
    sentences.push_back(
        phraseText("where", {{"what", objectName(id)}, {"where", objectLocation(id)}}));
  }
  std::string all = joined(sentences);
  if (!all.empty()) all.pop_back();  // the full stop: it is part of a sentence
  return reply(ReplyKind::kAnswer, "there", {{"what", all}});
}

/// The navigation chooses the nearest of several places.
ObjectReply FillMap::goToAnswer(const std::vector<Id>& objects,
                                const std::vector<Id>& places) const {
  const std::string name = objectName(objects.front());
  if (places.empty()) return reply(ReplyKind::kAnswer, "nowhere", {{"what", name}});
  ObjectReply out = reply(ReplyKind::kAnswer, "going",
                          {{"what", name}, {"where", objectLocation(objects.front())}});
  if (places.size() > 1) out.text = phraseText("rooms", {{"places", placeNames(places)}});
  return out;
}

std::vector<std::string> FillMap::unknownKinds(const ObjectDictionary& dictionary) const {
  std::set<std::string> kinds;
  for (const ObjectInstance& object : map_.objects) {
    const GenericObject* known = dictionary.find(object.kind);
    if (known == nullptr || known->classifier.views.empty()) kinds.insert(object.kind);
  }
  return {kinds.begin(), kinds.end()};
}

std::string FillMap::showRequest(const std::string& kind) const {
  return phraseText("show_me", {{"what", kind}});
}

std::string FillMap::learnedReply(const std::string& kind) const {
  return phraseText("learnt", {{"what", kind}});
}

// ---- Words ----

std::string FillMap::phraseText(const std::string& key, const Values& values) const {
  std::string text = parser_.grammar(language_).say(key);
  for (const auto& [name, value] : values) {
    const std::size_t at = text.find("{" + name + "}");
    if (at != std::string::npos) text.replace(at, name.size() + 2, value);
  }
  return text;
}

ObjectReply FillMap::reply(ReplyKind kind, const std::string& key, const Values& values) const {
  ObjectReply out;
  out.kind = kind;
  out.code = key;
  out.text = phraseText(key, values);
  return out;
}

ObjectReply FillMap::askBack(const ObjectStatement& statement, const std::string& key,
                             const Values& values, bool for_place) {
  const bool yes_or_no = key == "contradiction" || key == "count_contradiction";
  if (yes_or_no || for_place) pending_ = Pending{statement, for_place, false};
  return reply(ReplyKind::kQuestion, key, values);
}

std::string FillMap::enumeration(const std::vector<std::string>& items) const {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += phraseText(i + 1 == items.size() ? "and" : "comma");
    text += items[i];
  }
  return text;
}

std::string FillMap::placeNames(const std::vector<Id>& places) const {
  std::vector<std::string> names;
  for (const Id id : places) names.push_back(map_.findPlace(id)->name);
  return enumeration(names);
}

std::string FillMap::objectName(Id object) const {
  const ObjectInstance* found = map_.find(object);
  if (found == nullptr) return "";
  std::string text = found->kind;
  for (auto each = found->properties.rbegin(); each != found->properties.rend(); ++each) {
    const auto& [key, value] = *each;
    if (key == "furniture") continue;
    text = phraseText(key == "owner" ? "owned" : "described",
                      {{"property", parser_.propertyWord(language_, value)}, {"what", text}});
  }
  return text;
}

std::string FillMap::objectLocation(Id object) const {
  std::vector<std::string> items;
  for (const ObjectRelation* r : map_.relationsOf(object)) {
    if (r->other != 0) {
      items.push_back(phraseText(toString(r->word), {{"what", objectName(r->other)}}));
    }
  }
  const ObjectPlace* place = map_.findPlace(map_.placeOf(object));
  if (place != nullptr) items.push_back(phraseText("at", {{"place", place->name}}));
  return enumeration(items);
}

}  // namespace hyselam_objects

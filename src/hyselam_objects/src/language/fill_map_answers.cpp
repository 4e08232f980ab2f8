// Questions about the map, and the words of all answers.
#include <algorithm>
#include <set>

#include "hyselam_objects/fill_map.hpp"

namespace hyselam_objects {

// ---- Questions ----

ObjectReply FillMap::ask(const ObjectStatement& statement) {
  Id place = 0;
  if (statement.place) {
    const std::string said = placeName(*statement.place);
    place = said.empty() ? 0 : findPlace(said);
    if (place == 0) return reply(ReplyKind::kAnswer, "nothing");
  }
  std::vector<Id> landmarks;
  if (statement.landmark) {
    landmarks = statement.landmark->reference.empty() ? candidates(*statement.landmark)
                                                      : resolve(*statement.landmark, place_);
    if (landmarks.empty()) {
      return reply(ReplyKind::kAnswer, "unknown", {{"what", statement.landmark->text}});
    }
  }
  const auto wanted = [&](const ObjectInstance& object) {
    if (!statement.objects.empty()) {
      const ObjectPhrase& said = statement.objects.front();
      if (said.reference.empty()
              ? !fits(object, said)
              : std::find(subjects_.begin(), subjects_.end(), object.id) == subjects_.end()) {
        return false;
      }
    }
    if (place != 0 && map_.placeOf(object.id) != place) return false;
    if (!statement.landmark) return true;
    for (const ObjectRelation* r : map_.relationsOf(object.id)) {
      if (std::find(landmarks.begin(), landmarks.end(), r->other) == landmarks.end()) continue;
      const bool lies = isSupport(*statement.relation) &&
                        *statement.relation != RelationWord::kUnder && isSupport(r->word) &&
                        r->word != RelationWord::kUnder;
      if (r->word == *statement.relation || lies) return true;
    }
    return false;
  };
  ObjectReply out;
  for (const ObjectInstance& object : map_.objects) {
    if (wanted(object)) out.objects.push_back(object.id);
  }
  std::set<Id> places;
  for (const Id id : out.objects) {
    if (map_.placeOf(id) != 0) places.insert(map_.placeOf(id));
  }
  out.places.assign(places.begin(), places.end());
  std::vector<std::string> items;
  ObjectReply text;
  if (statement.intent == "how_many") {
    text = reply(ReplyKind::kAnswer, "how_many_answer",
                 {{"count", std::to_string(out.objects.size())}});
  } else if (statement.intent == "is_there") {
    for (const Id id : out.objects) {
      items.push_back(phrase("where", {{"what", name(id)}, {"where", whereIs(id)}}));
    }
    std::string all;
    for (const std::string& each : items) all += (all.empty() ? "" : " ") + each;
    if (!all.empty()) all.pop_back();
    text = out.objects.empty() ? reply(ReplyKind::kAnswer, "not_there")
                               : reply(ReplyKind::kAnswer, "there", {{"what", all}});
  } else if (out.objects.empty()) {
    text = statement.objects.empty()
               ? reply(ReplyKind::kAnswer, "nothing")
               : reply(ReplyKind::kAnswer, "unknown", {{"what", statement.objects.front().text}});
  } else if (statement.intent == "which_rooms") {
    for (const Id id : out.places) items.push_back(map_.findPlace(id)->name);
    text = reply(ReplyKind::kAnswer, "rooms", {{"places", list(items)}});
  } else if (statement.intent == "go_to" && out.places.empty()) {
    text = reply(ReplyKind::kAnswer, "nowhere", {{"what", name(out.objects.front())}});
  } else if (statement.intent == "go_to") {
    // To the nearest of them, which the one who drives finds.
    text = reply(ReplyKind::kAnswer, "going",
                 {{"what", name(out.objects.front())}, {"where", whereIs(out.objects.front())}});
    if (out.places.size() > 1) {
      for (const Id id : out.places) items.push_back(map_.findPlace(id)->name);
      text.text = phrase("rooms", {{"places", list(items)}});
    }
  } else if (statement.intent == "where_is") {
    for (const Id id : out.objects) {
      items.push_back(phrase("where", {{"what", name(id)}, {"where", whereIs(id)}}));
    }
    text = reply(ReplyKind::kAnswer, "where");
    text.text.clear();
    for (const std::string& each : items) text.text += (text.text.empty() ? "" : " ") + each;
  } else {
    for (const Id id : out.objects) items.push_back(name(id));
    text = reply(ReplyKind::kAnswer, "what", {{"what", list(items)}});
  }
  text.objects = out.objects;
  text.places = out.places;
  return text;
}

std::vector<std::string> FillMap::unknownKinds(const ObjectDictionary& dictionary) const {
  std::set<std::string> kinds;
  for (const ObjectInstance& object : map_.objects) {
    const GenericObject* known = dictionary.find(object.kind);
    if (known == nullptr || known->classifier.views.empty()) kinds.insert(object.kind);
  }
  return {kinds.begin(), kinds.end()};
}

std::string FillMap::askToShow(const std::string& kind) const {
  return phrase("show_me", {{"what", kind}});
}

std::string FillMap::learnt(const std::string& kind) const {
  return phrase("learnt", {{"what", kind}});
}

void FillMap::forgetContext() {
  subjects_.clear();
  place_ = 0;
  pending_.reset();
}

// ---- Words ----

std::string FillMap::phrase(const std::string& key,
                            const std::vector<std::pair<std::string, std::string>>& values) const {
  std::string text = parser_.grammar(language_).say(key);
  for (const auto& [name, value] : values) {
    const std::size_t at = text.find("{" + name + "}");
    if (at != std::string::npos) text.replace(at, name.size() + 2, value);
  }
  return text;
}

ObjectReply FillMap::reply(ReplyKind kind, const std::string& key,
                           const std::vector<std::pair<std::string, std::string>>& values) const {
  ObjectReply out;
  out.kind = kind;
  out.code = key;
  out.text = phrase(key, values);
  return out;
}

ObjectReply FillMap::askBack(const ObjectStatement& statement, const std::string& key,
                             const std::vector<std::pair<std::string, std::string>>& values,
                             bool for_place) {
  const bool yes_or_no = key == "contradiction" || key == "count_contradiction";
  if (yes_or_no || for_place) pending_ = Pending{{statement}, for_place, false};
  return reply(ReplyKind::kQuestion, key, values);
}

std::string FillMap::list(const std::vector<std::string>& items) const {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += phrase(i + 1 == items.size() ? "and" : "comma");
    text += items[i];
  }
  return text;
}

std::string FillMap::name(Id object) const {
  const ObjectInstance* found = map_.find(object);
  if (found == nullptr) return "";
  std::string text = found->kind;
  for (auto each = found->properties.rbegin(); each != found->properties.rend(); ++each) {
    const auto& [key, value] = *each;
    if (key == "furniture") continue;
    text = phrase(key == "owner" ? "owned" : "described",
                  {{"property", parser_.propertyIn(language_, value)}, {"what", text}});
  }
  return text;
}

std::string FillMap::whereIs(Id object) const {
  std::vector<std::string> items;
  for (const ObjectRelation* r : map_.relationsOf(object)) {
    if (r->other != 0) items.push_back(phrase(toString(r->word), {{"what", name(r->other)}}));
  }
  const ObjectPlace* place = map_.findPlace(map_.placeOf(object));
  if (place != nullptr) items.push_back(phrase("at", {{"place", place->name}}));
  return list(items);
}

}  // namespace hyselam_objects

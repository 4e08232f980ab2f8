// FillMap: answers to questions about the map.
#include <algorithm>
#include <set>

#include "hyselam_objects/language/fill_map.hpp"

namespace hyselam_objects {
// ---- Questions ----

namespace {

/// What is said where nothing is known.
std::string nothingKey(const ObjectStatement& question) {
  if (question.intent == "is_there") return "not_there";
  return question.intent == "how_many" ? "none" : "nothing";
}

}  // namespace

ObjectReply FillMap::answerQuestion(const ObjectStatement& question) {
  Id place = 0;
  if (question.place) {
    const std::string name = resolvePlaceName(*question.place);
    place = name.empty() ? 0 : findPlace(name);
    if (place == 0) return reply(ReplyKind::kAnswer, nothingKey(question));
  }
  last_question_ = question;
  std::vector<Id> landmarks;
  if (question.landmark) {
    landmarks = question.landmark->reference.empty()
                    ? candidates(*question.landmark)
                    : resolveReference(*question.landmark, last_place_);
    if (landmarks.empty()) {
      return reply(ReplyKind::kAnswer, "unknown", {{"what", question.landmark->text}});
    }
  }
  std::vector<std::vector<Id>> further;
  if (!narrow(question, &landmarks, &further)) {
    return reply(ReplyKind::kAnswer, nothingKey(question));
  }
  std::vector<Id> objects;
  std::set<Id> places;
  for (const ObjectInstance& object : map_.objects) {
    if (!matchesQuestion(object, question, place, landmarks)) continue;
    bool fits = true;
    for (std::size_t i = 0; i < further.size(); ++i) {
      const FurtherRelation& each = question.further[i];
      fits = fits && (each.of_landmark || isRelatedSo(object, each.word, further[i]));
    }
    if (!fits) continue;
    objects.push_back(object.id);
    if (map_.placeOf(object.id) != 0) places.insert(map_.placeOf(object.id));
  }
  if (!objects.empty()) {
    last_objects_ = objects;
    last_kind_ = map_.find(objects.front())->kind;
  }
  const std::vector<Id> all_places(places.begin(), places.end());
  ObjectReply out = answerText(question, objects, all_places);
  out.objects = objects;
  out.places = all_places;
  return out;
}

/// The last relation first: it tells which landmark the one before it means.
bool FillMap::narrow(const ObjectStatement& question, std::vector<Id>* landmarks,
                     std::vector<std::vector<Id>>* further) const {
  further->resize(question.further.size());
  const auto keepRelated = [&](std::size_t i, std::vector<Id>* before) {
    const FurtherRelation& each = question.further[i];
    before->erase(std::remove_if(before->begin(), before->end(),
                                 [&](Id id) {
                                   return !isRelatedSo(*map_.find(id), each.word, (*further)[i]);
                                 }),
                  before->end());
    return !before->empty();
  };
  for (std::size_t i = question.further.size(); i-- > 0;) {
    (*further)[i] = candidates(question.further[i].landmark);
    if ((*further)[i].empty()) return false;
    const bool narrows = i + 1 < further->size() && question.further[i + 1].of_landmark;
    if (narrows && !keepRelated(i + 1, &(*further)[i])) return false;
  }
  const bool narrows = !further->empty() && question.further.front().of_landmark;
  return !narrows || keepRelated(0, landmarks);
}

bool FillMap::matchesQuestion(const ObjectInstance& object, const ObjectStatement& question,
                              Id place, const std::vector<Id>& landmarks) const {
  const auto isIn = [](Id id, const std::vector<Id>& ids) {
    return std::find(ids.begin(), ids.end(), id) != ids.end();
  };
  if (!question.objects.empty()) {
    const ObjectPhrase& phrase = question.objects.front();
    const bool meant = !phrase.chosen.empty()      ? isIn(object.id, phrase.chosen)
                       : !phrase.reference.empty() ? isIn(object.id, last_objects_)
                       : phrase.other && phrase.definite
                           ? matchesPhrase(object, phrase) && !isIn(object.id, last_objects_)
                           : isIn(object.id, candidates(phrase));
    if (!meant) return false;
  }
  const bool parts = question.objects.empty() && !question.landmark;
  if (parts && object.properties.count("structure") != 0) return false;
  if (place != 0 && map_.placeOf(object.id) != place) return false;
  if (question.room) {
    const Id room = findPlace(resolvePlaceName(*question.room));
    const auto all = map_.relationsOf(object.id);
    return std::any_of(all.begin(), all.end(), [&](const ObjectRelation* r) {
      return room != 0 && r->place == room && r->word == *question.relation;
    });
  }
  return !question.landmark || isRelatedSo(object, *question.relation, landmarks);
}

bool FillMap::isRelatedSo(const ObjectInstance& object, RelationWord word,
                          const std::vector<Id>& others) const {
  const auto isOther = [&](Id id) {
    return std::find(others.begin(), others.end(), id) != others.end();
  };
  const auto carried = [](RelationWord each) {
    return isSupport(each) && each != RelationWord::kUnder;
  };
  const auto isBeside = [](RelationWord each) {
    return each == RelationWord::kNear || each == RelationWord::kAgainst ||
           each == RelationWord::kBetween || each == RelationWord::kLeft ||
           each == RelationWord::kRight;
  };
  if (word == RelationWord::kNear) {  // holds both ways
    for (const Id other : others) {
      for (const ObjectRelation* r : map_.relationsOf(other)) {
        if (r->other == object.id && isBeside(r->word)) return true;
      }
    }
  }
  for (const ObjectRelation* r : map_.relationsOf(object.id)) {
    if (!isOther(r->other)) continue;
    if (word == RelationWord::kNear && isBeside(r->word)) return true;
    // "on the table" asks for what is over it or in it, too.
    if (r->word == word || (carried(word) && carried(r->word))) return true;
  }
  return false;
}

ObjectReply FillMap::answerText(const ObjectStatement& question, const std::vector<Id>& objects,
                                const std::vector<Id>& places) const {
  if (question.intent == "how_many" && objects.empty()) return reply(ReplyKind::kAnswer, "none");
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
    if (places.empty()) return reply(ReplyKind::kAnswer, "nothing");
    ObjectReply rooms = reply(ReplyKind::kAnswer, "rooms");
    rooms.text = sentencesOf({placeNames(places)});
    return rooms;
  }
  if (question.intent == "go_to") return goToAnswer(question, objects, places);
  if (question.intent == "is_like_asked" || question.intent == "what_like") {
    return propertyAnswer(question, objects);
  }
  if (question.intent == "where_is" || question.intent == "who_has") {
    ObjectReply out = reply(ReplyKind::kAnswer, "where");
    out.text = sentencesOf(factsOf(objects, true, "where", true));
    if (question.intent == "who_has") out.text = phraseText("who_has") + " " + out.text;
    return out;
  }
  const bool many = map_.find(objects.front()) != nullptr && startsWithMany(objects);
  return reply(ReplyKind::kAnswer, many ? "what_many" : "what",
               {{"what", countedNames(objects, false)}});
}

/// Whether the first kind in a list is told in the plural.
bool FillMap::startsWithMany(const std::vector<Id>& objects) const {
  const ObjectInstance& first = *map_.find(objects.front());
  return std::count_if(objects.begin(), objects.end(), [&](Id id) {
           const ObjectInstance& each = *map_.find(id);
           return parser_.isSameKind(each.kind, first.kind) && each.properties == first.properties;
         }) > 1;
}

/// "What colour is the cup?", "is the cup red?"
ObjectReply FillMap::propertyAnswer(const ObjectStatement& question,
                                    const std::vector<Id>& objects) const {
  if (question.intent == "what_like") {
    std::vector<std::string> items;
    for (const Id id : objects) {
      const ObjectInstance& object = *map_.find(id);
      const auto colour = object.properties.find("colour");
      if (colour == object.properties.end()) continue;
      const std::string word =
          parser_.propertyWord(language_, colour->second, parser_.kindIn(language_, object.kind));
      if (std::find(items.begin(), items.end(), word) == items.end()) items.push_back(word);
    }
    if (items.empty()) return reply(ReplyKind::kAnswer, "unknown_colour");
    return reply(ReplyKind::kAnswer, "colour", {{"what", enumeration(items)}});
  }
  std::vector<Id> so, otherwise;
  for (const Id id : objects) {
    const auto& known = map_.find(id)->properties;
    bool all = true, against = false;
    for (const auto& [key, value] : question.properties) {
      const auto found = known.find(key);
      all = all && found != known.end() && found->second == value;
      against = against || (found != known.end() && found->second != value);
    }
    if (all) so.push_back(id);
    if (against) otherwise.push_back(id);
  }
  if (!so.empty()) return isThereAnswer(so);
  if (otherwise.empty()) return reply(ReplyKind::kAnswer, "not_there");
  return reply(ReplyKind::kAnswer, "no_but", {{"what", enumeration(factsOf(otherwise, true))}});
}

ObjectReply FillMap::isThereAnswer(const std::vector<Id>& objects) const {
  if (objects.empty()) return reply(ReplyKind::kAnswer, "not_there");
  std::string all;
  for (const std::string& fact : factsOf(objects, true)) all += (all.empty() ? "" : "; ") + fact;
  return reply(ReplyKind::kAnswer, "there", {{"what", all}});
}

/// The navigation chooses the nearest of several places.
ObjectReply FillMap::goToAnswer(const ObjectStatement& question, const std::vector<Id>& objects,
                                const std::vector<Id>& places) const {
  if (places.empty()) {
    return reply(ReplyKind::kAnswer, "nowhere", {{"what", objectName(objects.front())}});
  }
  ObjectReply out = reply(ReplyKind::kAnswer, "going");
  out.text = sentencesOf(factsOf({objects.front()}, true));
  if (places.size() > 1) out.text = sentencesOf({placeNames(places)});
  const auto fetch = question.words.find("fetch");
  if (fetch != question.words.end()) out.text += " " + phraseText("cannot_carry");
  return out;
}

/// "The pen is in the lab. The cup is in the kitchen."
std::string FillMap::sentencesOf(const std::vector<std::string>& facts) {
  std::string text;
  for (std::string fact : facts) {
    if (!fact.empty() && fact[0] >= 'a' && fact[0] <= 'z') {
      fact[0] = static_cast<char>(fact[0] - 'a' + 'A');
    }
    text += (text.empty() ? "" : " ") + fact + ".";
  }
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

std::string FillMap::kindToShow(const ObjectDictionary& dictionary,
                                const std::vector<ObjectReply>& replies) {
  for (const ObjectReply& reply : replies) {
    if (reply.kind == ReplyKind::kQuestion) return "";
  }
  for (const ObjectReply& reply : replies) {
    if (reply.kind != ReplyKind::kDone || reply.facts.empty()) continue;
    for (const Id id : reply.objects) {
      const ObjectInstance* object = map_.find(id);
      if (object == nullptr || parser_.isStructure(object->kind) || parser_.isTop(object->kind)) {
        continue;
      }
      const GenericObject* known = dictionary.find(object->kind);
      if (known != nullptr && !known->classifier.views.empty()) continue;
      if (shown_kinds_.insert(object->kind).second) return object->kind;
    }
  }
  return "";
}

std::string FillMap::showRequest(const std::string& kind) const {
  return contracted(phraseText("show_me", {{"what", formed("a", kind, {{"what", kind}})}}));
}

std::string FillMap::learnedReply(const std::string& kind) const {
  return contracted(phraseText("learnt", {{"what", formed("a", kind, {{"what", kind}})}}));
}

std::string FillMap::noCameraReply(const std::string& kind) const {
  return contracted(phraseText("no_camera", {{"what", formed("a", kind, {{"what", kind}})}}));
}

}  // namespace hyselam_objects

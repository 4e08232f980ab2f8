// FillMap: statements on where objects are. First the whole statement is interpreted, which may
// lead to a question; only then the map is changed.
#include <algorithm>
#include <map>

#include "statement_meaning.hpp"

namespace hyselam_objects {

ObjectReply FillMap::recordObjects(const ObjectStatement& statement) {
  StatementMeaning meaning;
  Question question = interpretPlace(statement, meaning);
  if (!question) question = interpretLandmark(statement, meaning);
  if (!question) question = interpretPhrases(statement, meaning);
  if (!question) question = checkPlaceKnown(statement, meaning);
  if (!question) question = checkContradictions(statement, meaning);
  return question ? *question : applyMeaning(statement, meaning);
}

// ---- Interpretation ----

FillMap::Question FillMap::interpretPlace(const ObjectStatement& statement,
                                          StatementMeaning& meaning) {
  meaning.target.word = statement.relation;
  meaning.place_stated = statement.place.has_value();
  if (statement.room) {
    meaning.room_name = resolvePlaceName(*statement.room);
    if (meaning.room_name.empty()) {
      return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", statement.room->text}});
    }
    if (!mayRelateToPlace(*statement.relation)) {
      return reply(ReplyKind::kQuestion, "is_place", {{"what", statement.room->text}});
    }
    meaning.target.room = findPlace(meaning.room_name);
  }
  if (!statement.place) return std::nullopt;
  const std::string name = resolvePlaceName(*statement.place);
  if (name.empty()) return askBack(statement, "which_place", {}, Asked::kPlace);
  meaning.target.place = findPlace(name);
  return std::nullopt;
}

FillMap::Question FillMap::interpretLandmark(const ObjectStatement& statement,
                                             StatementMeaning& meaning) {
  Id& place = meaning.target.place;
  const bool stated = meaning.place_stated;
  if (statement.landmark) {
    const ObjectPhrase& landmark = *statement.landmark;
    if (landmark.has_count && landmark.count > 1) {
      return reply(ReplyKind::kQuestion, "which_of_many",
                   {{"count", std::to_string(landmark.count)}, {"what", landmark.text}});
    }
    if (const auto either = subjectOrLandmark(statement)) {
      return askWhich(statement, landmark, *either, true);
    }
    std::vector<Id>& found = meaning.landmarks;
    found = resolveReference(landmark, stated ? place : last_place_, stated);
    if (stated && found.size() == 1 && landmark.reference.empty() && landmark.chosen.empty() &&
        map_.placeOf(found.front()) != 0 && map_.placeOf(found.front()) != place) {
      found.clear();  // "on the table in the kitchen": not that in the office
    }
    const bool is_elsewhere = found.size() == 1 && map_.placeOf(found.front()) != 0 &&
                              map_.placeOf(found.front()) != findPlace(robot_place_);
    if (!stated && just_came_ && last_place_ == 0 && is_elsewhere && landmark.reference.empty() &&
        landmark.chosen.empty()) {
      found.clear();  // "on the table", said in the kitchen: not that in the office
    }
    if (found.size() > 1) return askWhich(statement, landmark, found, true);
    if (found.empty() && !landmark.reference.empty()) {
      return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", landmark.text}});
    }
    if (!stated && !found.empty()) place = map_.placeOf(found.front());
  }
  const bool elsewhere =
      statement.room || (!meaning.landmarks.empty() && isRelatedToRoom(meaning.landmarks.front()));
  if (!stated && place == 0 && !elsewhere) {
    place = last_place_ != 0 ? last_place_ : robot_place_.empty() ? 0 : findPlace(robot_place_);
  }
  meaning.place_is_new = stated && place == 0;
  meaning.robot_place_is_new = !stated && place == 0 && !elsewhere && !robot_place_.empty();
  return std::nullopt;
}

/// "The cat is on the sofa. The dog is under it.": both may be meant.
std::optional<std::vector<Id>> FillMap::subjectOrLandmark(const ObjectStatement& statement) const {
  const bool carries = isSupport(*statement.relation) && *statement.relation != RelationWord::kIn &&
                       *statement.relation != RelationWord::kInside;
  if (statement.landmark->reference != "it" || !statement.landmark->chosen.empty() || !carries ||
      last_objects_.size() != 1) {
    return std::nullopt;
  }
  const ObjectInstance* landmark = map_.find(last_landmark_);
  const bool either = landmark != nullptr && landmark->id != last_objects_.front() &&
                      parser_.isTop(landmark->kind) &&
                      !parser_.isTop(map_.find(last_objects_.front())->kind);
  if (!either) return std::nullopt;
  return std::vector<Id>{last_objects_.front(), landmark->id};
}

FillMap::Question FillMap::interpretPhrases(const ObjectStatement& statement,
                                            StatementMeaning& meaning) {
  for (std::size_t i = 0; i < statement.objects.size(); ++i) {
    const ObjectPhrase& phrase = statement.objects[i];
    const bool is_landmark = statement.landmark && phrase.reference.empty() &&
                             statement.landmark->reference.empty() &&
                             phrase.kind == statement.landmark->kind && phrase.count == 1 &&
                             phrase.properties == statement.landmark->properties;
    if (is_landmark && statement.objects.size() == 1) {
      return reply(ReplyKind::kQuestion, "itself", {{"word", toString(*statement.relation)}});
    }
    if (is_landmark) {
      for (PhraseMeaning& before : meaning.phrases) before.related = false;
      meaning.landmark_is_listed = true;
      continue;
    }
    if (phrase.plural && !phrase.has_count && phrase.reference.empty() &&
        !(phrase.definite && !candidates(phrase).empty())) {
      const std::string kinds = parser_.pluralOf(language_, phrase.kind);
      ObjectReply how_many = askBack(statement, "how_many", {}, Asked::kCount);
      how_many.text = formed("how_many", phrase.kind, {{"what", kinds}});
      return how_many;
    }
    PhraseMeaning found;
    found.phrase = &phrase;
    Question question;
    if (phrase.definite || !phrase.reference.empty()) {
      question = interpretDefinite(statement, meaning, i, found);
    } else if (phrase.another) {
      found.missing = phrase.count;
    } else {
      question = interpretIndefinite(statement, meaning, found);
    }
    if (question) return question;
    meaning.phrases.push_back(std::move(found));
  }
  return std::nullopt;
}

/// "the pen", "it", "the two cups".
FillMap::Question FillMap::interpretDefinite(const ObjectStatement& statement,
                                             const StatementMeaning& meaning, std::size_t index,
                                             PhraseMeaning& found) {
  const ObjectPhrase& phrase = *found.phrase;
  const Target& target = meaning.target;
  // "The pen is in the office": where it is now is not where it was known to be.
  const bool tells_place = statement.intent == "is_at" && statement.objects.front().definite;
  const Id near_place = tells_place ? 0 : target.place;
  found.known = resolveReference(phrase, near_place != 0 ? near_place : last_place_);
  if (found.known.empty() && !phrase.reference.empty()) {
    return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", phrase.text}});
  }
  const auto whichOne = [&] { return askWhich(statement, phrase, found.known, false, index); };
  const bool many = phrase.plural || phrase.reference == "them" || phrase.reference == "same";
  if (statement.background && meaning.place_stated && found.known.size() == 1 &&
      map_.placeOf(found.known.front()) != 0 && map_.placeOf(found.known.front()) != target.place) {
    found.known.clear();  // "on the tray on the table in the kitchen": not that in the office
  }
  if (many && phrase.has_count && static_cast<int>(found.known.size()) != phrase.count &&
      !found.known.empty()) {
    return whichOne();
  }
  if (!many && found.known.size() > 1) {
    // "The pen is on the table": perhaps one of them is known to lie there.
    std::vector<Id> fitting;
    for (const Id id : found.known) {
      const bool there = target.place != 0 && map_.placeOf(id) == target.place;
      if (there && contradiction(id, meaning.knownTarget()).empty()) fitting.push_back(id);
    }
    if (fitting.size() != 1) return whichOne();
    found.known = fitting;
  }
  if (found.known.empty()) found.missing = phrase.count;
  return std::nullopt;
}

/// "a pen", "two cups".
FillMap::Question FillMap::interpretIndefinite(const ObjectStatement& statement,
                                               StatementMeaning& meaning, PhraseMeaning& found) {
  const ObjectPhrase& phrase = *found.phrase;
  Target wanted = meaning.knownTarget();
  std::vector<Id> same, possible;  // known to be related so; not known to be related otherwise
  for (const Id id : candidates(phrase)) {
    if (wanted.place == 0 || map_.placeOf(id) != wanted.place) continue;
    if (wanted.landmark == id) continue;
    bool related = !wanted.word;
    for (const ObjectRelation* r : map_.relationsOf(id)) {
      related = related || (wanted.word && r->word == *wanted.word && r->other == wanted.landmark &&
                            r->other != 0);
    }
    if (related) {
      same.push_back(id);
    } else {
      // A landmark that is new is none of those that anything rests on.
      if (statement.landmark && meaning.landmarks.empty()) wanted.landmark = map_.next_object_id;
      if (contradiction(id, wanted).empty()) possible.push_back(id);
    }
  }
  const int known = static_cast<int>(same.size());
  if (phrase.has_count && known > 0 && known != phrase.count && !statement.correction) {
    return askBack(statement, "count_contradiction",
                   {{"count", std::to_string(known)},
                    {"what", phrase.kind},
                    {"said", std::to_string(phrase.count)}});
  }
  same.insert(same.end(), possible.begin(), possible.end());
  for (const Id id : same) {
    if (static_cast<int>(found.known.size()) < phrase.count) found.known.push_back(id);
  }
  found.missing = phrase.count - static_cast<int>(found.known.size());
  for (int i = phrase.count; statement.correction && phrase.has_count && i < known; ++i) {
    meaning.surplus.push_back(same[static_cast<std::size_t>(i)]);
  }
  return std::nullopt;
}

FillMap::Question FillMap::checkPlaceKnown(const ObjectStatement& statement,
                                           StatementMeaning& meaning) {
  const auto& phrases = meaning.phrases;
  const bool all_placed = std::all_of(phrases.begin(), phrases.end(), [&](const PhraseMeaning& m) {
    return m.missing == 0 && std::all_of(m.known.begin(), m.known.end(),
                                         [&](Id id) { return map_.placeOf(id) != 0; });
  });
  const bool place_known =
      meaning.target.place != 0 || meaning.place_is_new || meaning.robot_place_is_new;
  if (!place_known && !all_placed && !statement.room && !statement.continues) {
    return askBack(statement, "which_place", {}, Asked::kPlace);
  }
  if (!meaning.place_stated && !phrases.empty() && !phrases.front().known.empty() &&
      statement.objects.front().definite && meaning.landmarks.empty()) {
    // "the pen is on a book": where the pen is
    meaning.target.place = map_.placeOf(phrases.front().known.front());
  }
  return std::nullopt;
}

FillMap::Question FillMap::checkContradictions(const ObjectStatement& statement,
                                               const StatementMeaning& meaning) {
  if (statement.correction) return std::nullopt;
  const bool landmark_is_new = statement.landmark && meaning.landmarks.empty();
  for (const PhraseMeaning& phrase : meaning.phrases) {
    Target wanted = meaning.knownTarget();
    if (!phrase.related) wanted.word.reset();
    if (meaning.place_is_new) wanted.place = map_.next_place_id;
    for (const Id id : phrase.known) {
      std::string known = contradiction(id, wanted);
      if (known.empty() && landmark_is_new && wanted.word && isSupport(*wanted.word)) {
        Target on_new = wanted;
        on_new.landmark = map_.next_object_id;
        known = contradiction(id, on_new);
      }
      if (!known.empty()) {
        return askBack(statement, "contradiction", {{"known", known}, {"said", statement.text}});
      }
    }
  }
  return std::nullopt;
}

// ---- Changes ----

ObjectReply FillMap::applyMeaning(const ObjectStatement& statement, StatementMeaning& meaning) {
  const ObjectMap before = map_;
  removeSurplus(meaning);
  Target& target = meaning.target;
  if (meaning.place_is_new) target.place = map_.addPlace(resolvePlaceName(*statement.place));
  if (meaning.robot_place_is_new) target.place = map_.addPlace(robot_place_);
  if (statement.landmark) {
    Target at;
    at.place = target.place;
    target.landmark =
        meaning.landmarks.empty() ? addObject(*statement.landmark, at) : meaning.landmarks.front();
    if (map_.placeOf(target.landmark) == 0) applyTarget(target.landmark, at);
  } else if (meaning.landmark_is_listed) {
    target.word.reset();
  }
  if (!meaning.room_name.empty() && target.room == 0) {
    target.room = map_.addPlace(meaning.room_name);
  }
  just_came_ = false;
  const std::vector<Id> objects_before = last_objects_;
  last_objects_.clear();
  std::vector<Id> told[2];  // indefinite, definite
  std::map<Id, std::string> places_before;
  for (const PhraseMeaning& phrase : meaning.phrases) {
    for (const Id id : phrase.known) places_before[id] = objectLocation(id);
  }
  for (const PhraseMeaning& phrase : meaning.phrases) {
    const std::vector<Id> ids = applyPhrase(phrase, target);
    last_objects_.insert(last_objects_.end(), ids.begin(), ids.end());
    for (const Id id : ids) told[phrase.phrase->definite ? 1 : 0].push_back(id);
  }
  if (last_objects_.empty() && target.landmark != 0) last_objects_ = {target.landmark};
  if (!last_objects_.empty()) last_kind_ = map_.find(last_objects_.front())->kind;
  last_place_ = target.place;
  if (!last_objects_.empty() && map_.placeOf(last_objects_.front()) != 0) {
    last_place_ = map_.placeOf(last_objects_.front());
  }
  last_landmark_ = target.landmark;
  last_added_.clear();
  for (const ObjectInstance& object : map_.objects) {
    if (before.find(object.id) == nullptr) last_added_.push_back(object.id);
  }
  if (!statement.background) last_statement_ = statement;
  landmarks_told_.clear();
  const std::vector<Id> recorded = last_objects_;
  if (statement.is_landmark) {
    landmarks_told_ = recorded;
    last_objects_ = objects_before;
  }
  ObjectReply out = reply(ReplyKind::kDone, map_ == before ? "known" : "done");
  if (!(map_ == before)) {
    map_.stamp = std::max(map_.stamp, stamp_);
    for (const bool definite : {false, true}) {
      for (std::string& fact :
           changedFacts(told[definite ? 1 : 0], definite, before, places_before)) {
        out.facts.push_back(std::move(fact));
      }
    }
  }
  out.objects = recorded;
  if (last_place_ != 0) out.places = {last_place_};
  return out;
}

/// What was taken down, with where the objects were before that have moved.
std::vector<std::string> FillMap::changedFacts(const std::vector<Id>& objects, bool definite,
                                               const ObjectMap& before,
                                               const std::map<Id, std::string>& places_before) {
  std::vector<Id> as_before;
  std::map<std::string, std::vector<Id>> moved;
  for (const Id id : objects) {
    const auto was = places_before.find(id);
    const auto old = before.relationsOf(id);
    const bool has_moved =
        was != places_before.end() && !was->second.empty() &&
        std::any_of(old.begin(), old.end(), [&](const ObjectRelation* r) {
          const auto now = map_.relationsOf(id);
          return std::none_of(now.begin(), now.end(), [&](const ObjectRelation* each) {
            return each->word == r->word && each->other == r->other && each->place == r->place;
          });
        });
    if (has_moved) {
      moved[was->second].push_back(id);
    } else {
      as_before.push_back(id);
    }
  }
  std::vector<std::string> facts = factsOf(as_before, definite);
  for (const auto& [where, ids] : moved) {
    for (const std::string& fact : factsOf(ids, true)) {
      facts.push_back(fact + " " + phraseText("before", {{"where", where}}));
    }
  }
  return facts;
}

void FillMap::removeSurplus(const StatementMeaning& meaning) {
  for (const Id id : meaning.surplus) {
    const bool meant =
        std::any_of(meaning.phrases.begin(), meaning.phrases.end(), [id](const PhraseMeaning& m) {
          return std::find(m.known.begin(), m.known.end(), id) != m.known.end();
        });
    if (!meant) map_.remove(id);  // another phrase may mean it
  }
}

/// Returns the objects that the phrase means, new ones last.
std::vector<Id> FillMap::applyPhrase(const PhraseMeaning& phrase, const Target& target) {
  Target to = target;
  if (!phrase.related) {
    to.word.reset();
    to.landmark = 0;
  }
  std::vector<Id> ids = phrase.known;
  for (const Id id : ids) {
    ObjectInstance& object = *map_.find(id);
    object.properties.insert(phrase.phrase->properties.begin(), phrase.phrase->properties.end());
    object.described = true;
    applyTarget(id, to);
  }
  for (int i = 0; i < phrase.missing; ++i) ids.push_back(addObject(*phrase.phrase, to));
  return ids;
}

}  // namespace hyselam_objects

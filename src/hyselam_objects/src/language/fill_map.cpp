#include "hyselam_objects/fill_map.hpp"

#include <algorithm>
#include <set>

#include "fill_map_target.hpp"

namespace hyselam_objects {

using hyselam_topo::SaidName;
using hyselam_topo::UtteranceKind;

const char* toString(ReplyKind kind) {
  constexpr std::array<const char*, 4> kNames{"done", "answer", "question", "not understood"};
  return kNames.at(static_cast<std::size_t>(kind));
}

FillMap::FillMap(const ObjectParser* parser, ObjectMap* map) : parser_(*parser), map_(*map) {}

std::vector<ObjectReply> FillMap::say(const std::string& text) {
  // The detector may have joined or dropped some in the meantime.
  subjects_.erase(std::remove_if(subjects_.begin(), subjects_.end(),
                                 [this](Id id) { return map_.find(id) == nullptr; }),
                  subjects_.end());
  std::set<std::string> expected;
  if (pending_ && pending_->for_place) expected.insert("place_answer");
  if (pending_ && pending_->for_count) expected.insert("count_answer");
  std::vector<ObjectReply> replies;
  for (const ObjectStatement& statement : parser_.parse(text, expected, language_)) {
    replies.push_back(take(statement));
  }
  return replies;
}

ObjectReply FillMap::take(const ObjectStatement& statement) {
  language_ = statement.language;
  switch (statement.kind) {
    case UtteranceKind::kNotUnderstood:
      return reply(ReplyKind::kNotUnderstood, "not_understood",
                   {{"text", statement.text}, {"reason", statement.reason}});
    case UtteranceKind::kAnswer:
      return answer(statement);
    case UtteranceKind::kQuestion:
      return ask(statement);
    default:
      break;
  }
  pending_.reset();
  if (statement.intent == "go_to") return ask(statement);
  if (statement.intent == "forget_object") return forget(statement);
  if (statement.intent == "this_is") {
    ObjectReply out = reply(ReplyKind::kDone, "shown", {{"what", statement.objects.front().kind}});
    out.kind_of_object = statement.objects.front().kind;
    return out;
  }
  if (statement.intent == "is_like") return describe(statement);
  return tell(statement);
}

// ---- Statements ----

ObjectReply FillMap::tell(const ObjectStatement& statement) {
  // Everything is found before anything is changed.
  Target target;
  target.word = statement.relation;
  if (statement.place) {
    const std::string said = placeName(*statement.place);
    if (said.empty()) return askBack(statement, "which_place", {}, true);
    target.place = findPlace(said);
  }
  const bool has_place = statement.place.has_value();
  std::vector<Id> landmarks;
  if (statement.landmark) {
    if (statement.landmark->count_said && statement.landmark->count > 1) {
      return askBack(statement, "which_one",
                     {{"count", std::to_string(statement.landmark->count)},
                      {"what", statement.landmark->kind}});
    }
    landmarks = resolve(*statement.landmark, has_place ? target.place : place_, has_place);
    if (has_place && landmarks.size() == 1 && statement.landmark->reference.empty() &&
        map_.placeOf(landmarks.front()) != 0 && map_.placeOf(landmarks.front()) != target.place) {
      landmarks.clear();  // "on the table in the kitchen": not that in the office
    }
    if (landmarks.size() > 1) {
      return askBack(
          statement, "which_one",
          {{"count", std::to_string(landmarks.size())}, {"what", statement.landmark->text}});
    }
    if (landmarks.empty() && !statement.landmark->reference.empty()) {
      return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", statement.landmark->text}});
    }
    if (!has_place && !landmarks.empty()) target.place = map_.placeOf(landmarks.front());
  }
  const bool refers = statement.objects.front().definite;
  if (!has_place && target.place == 0) {
    target.place = place_ != 0 ? place_ : here_.empty() ? 0 : findPlace(here_);
  }
  const bool place_is_new = has_place && target.place == 0;
  const bool here_is_new = !has_place && target.place == 0 && !here_.empty();

  // What each phrase means: known ones, and how many are to be added.
  struct Meant {
    const ObjectPhrase* said;
    std::vector<Id> known;
    int missing = 0;
    bool related = true;
  };
  std::vector<Meant> all;
  std::vector<Id> surplus;
  bool landmark_told = false;
  for (const ObjectPhrase& said : statement.objects) {
    Meant meant{&said, {}, 0, true};
    const bool is_landmark = statement.landmark && said.reference.empty() &&
                             statement.landmark->reference.empty() &&
                             said.kind == statement.landmark->kind && said.count == 1 &&
                             said.properties == statement.landmark->properties;
    if (is_landmark && statement.objects.size() == 1) {
      return reply(ReplyKind::kQuestion, "itself", {{"word", toString(*statement.relation)}});
    }
    if (is_landmark) {
      for (Meant& before : all) before.related = false;
      landmark_told = true;
      continue;
    }
    if (said.plural && !said.count_said && said.reference.empty() &&
        !(said.definite && !candidates(said).empty())) {
      ObjectReply asked = askBack(statement, "how_many", {{"what", said.text}});
      pending_ = Pending{{statement}, false, true};
      return asked;
    }
    const Id near_place = statement.intent == "is_at" && refers ? 0 : target.place;
    if (said.definite) {
      meant.known = resolve(said, near_place != 0 ? near_place : place_);
      if (meant.known.empty() && !said.reference.empty()) {
        return reply(ReplyKind::kQuestion, "no_antecedent", {{"what", said.text}});
      }
      const bool many = said.plural || said.reference == "them";
      if (many && said.count_said && static_cast<int>(meant.known.size()) != said.count &&
          !meant.known.empty()) {
        return askBack(statement, "which_one",
                       {{"count", std::to_string(meant.known.size())}, {"what", said.text}});
      }
      if (!many && meant.known.size() > 1) {
        // "The pen is on the table": perhaps one of them is known to lie there.
        std::vector<Id> fitting;
        for (const Id id : meant.known) {
          Target wanted = target;
          wanted.landmark = landmarks.empty() ? 0 : landmarks.front();
          const bool there = target.place != 0 && map_.placeOf(id) == target.place;
          if (there && contradiction(id, wanted).empty()) fitting.push_back(id);
        }
        if (fitting.size() != 1) {
          return askBack(statement, "which_one",
                         {{"count", std::to_string(meant.known.size())}, {"what", said.text}});
        }
        meant.known = fitting;
      }
      if (meant.known.empty()) meant.missing = said.count;
    } else if (said.another) {
      meant.missing = said.count;
    } else {
      Target wanted = target;
      wanted.landmark = landmarks.empty() ? 0 : landmarks.front();
      std::vector<Id> same, perhaps;
      for (const Id id : candidates(said)) {
        if (target.place == 0 || map_.placeOf(id) != target.place) continue;
        if (wanted.landmark == id) continue;
        bool related = !wanted.word;
        for (const ObjectRelation* r : map_.relationsOf(id)) {
          related = related || (wanted.word && r->word == *wanted.word &&
                                r->other == wanted.landmark && r->other != 0);
        }
        if (related) {
          same.push_back(id);
        } else {
          // A landmark that is new is none of those that anything rests on.
          if (statement.landmark && landmarks.empty()) wanted.landmark = map_.next_object_id;
          if (contradiction(id, wanted).empty()) perhaps.push_back(id);
        }
      }
      const int known = static_cast<int>(same.size());
      if (said.count_said && known > 0 && known != said.count && !statement.correction) {
        return askBack(statement, "count_contradiction",
                       {{"count", std::to_string(known)},
                        {"what", said.kind},
                        {"said", std::to_string(said.count)}});
      }
      same.insert(same.end(), perhaps.begin(), perhaps.end());
      for (const Id id : same) {
        if (static_cast<int>(meant.known.size()) < said.count) meant.known.push_back(id);
      }
      meant.missing = said.count - static_cast<int>(meant.known.size());
      // Corrected to fewer: the surplus goes.
      for (int i = said.count; statement.correction && said.count_said && i < known; ++i) {
        surplus.push_back(same[static_cast<std::size_t>(i)]);
      }
    }
    all.push_back(std::move(meant));
  }

  const bool anything_placed =
      target.place != 0 || place_is_new || here_is_new ||
      std::all_of(all.begin(), all.end(), [&](const Meant& m) {
        return m.missing == 0 && std::all_of(m.known.begin(), m.known.end(),
                                             [&](Id id) { return map_.placeOf(id) != 0; });
      });
  if (!anything_placed) return askBack(statement, "which_place", {}, true);
  if (!has_place && !all.empty() && !all.front().known.empty() && refers && landmarks.empty()) {
    target.place = map_.placeOf(all.front().known.front());  // "the pen is on a book": where it is
  }
  if (!statement.correction) {
    for (const Meant& meant : all) {
      for (const Id id : meant.known) {
        Target wanted = target;
        wanted.landmark = landmarks.empty() ? 0 : landmarks.front();
        if (!meant.related) wanted.word.reset();
        if (place_is_new) wanted.place = map_.next_place_id;
        std::string known = contradiction(id, wanted);
        if (known.empty() && statement.landmark && landmarks.empty() && wanted.word &&
            isSupport(*wanted.word)) {
          wanted.landmark = map_.next_object_id;
          known = contradiction(id, wanted);
        }
        if (!known.empty()) {
          return askBack(statement, "contradiction", {{"known", known}, {"said", statement.text}});
        }
      }
    }
  }

  // ---- Now the map changes. ----
  for (const Id id : surplus) {
    const bool meant = std::any_of(all.begin(), all.end(), [id](const Meant& m) {
      return std::find(m.known.begin(), m.known.end(), id) != m.known.end();
    });
    if (!meant) map_.remove(id);  // another phrase may mean it
  }
  const ObjectMap before = map_;
  if (place_is_new) target.place = map_.addPlace(placeName(*statement.place));
  if (here_is_new) target.place = map_.addPlace(here_);
  if (statement.landmark) {
    Target at;
    at.place = target.place;
    target.landmark = landmarks.empty() ? add(*statement.landmark, at) : landmarks.front();
    if (map_.placeOf(target.landmark) == 0) put(target.landmark, at);
  } else if (landmark_told) {
    target.word.reset();
  }
  subjects_.clear();
  ObjectReply out;
  std::vector<std::string> told;
  for (const Meant& meant : all) {
    Target to = target;
    if (!meant.related) {
      to.word.reset();
      to.landmark = 0;
    }
    std::vector<Id> ids = meant.known;
    for (const Id id : ids) {
      map_.find(id)->properties.insert(meant.said->properties.begin(),
                                       meant.said->properties.end());
      map_.find(id)->told = true;
      put(id, to);
    }
    for (int i = 0; i < meant.missing; ++i) ids.push_back(add(*meant.said, to));
    subjects_.insert(subjects_.end(), ids.begin(), ids.end());
    for (const Id id : ids) told.push_back(name(id) + " " + whereIs(id));
  }
  if (subjects_.empty() && target.landmark != 0) subjects_ = {target.landmark};
  place_ = target.place;
  if (!subjects_.empty() && map_.placeOf(subjects_.front()) != 0) {
    place_ = map_.placeOf(subjects_.front());
  }
  if (map_ == before) {
    out = reply(ReplyKind::kDone, "known");
  } else {
    map_.stamp = std::max(map_.stamp, stamp_);
    out = reply(ReplyKind::kDone, "done", {{"what", list(told)}});
  }
  out.objects = subjects_;
  if (place_ != 0) out.places = {place_};
  return out;
}

ObjectReply FillMap::describe(const ObjectStatement& statement) {
  std::vector<Id> all;
  for (const ObjectPhrase& said : statement.objects) {
    const std::vector<Id> ids = resolve(said, place_);
    if (ids.empty()) {
      return reply(ReplyKind::kQuestion, said.reference.empty() ? "unknown" : "no_antecedent",
                   {{"what", said.text}});
    }
    const bool many = said.plural || said.reference == "them";
    if (!many && ids.size() > 1) {
      return askBack(statement, "which_one",
                     {{"count", std::to_string(ids.size())}, {"what", said.text}});
    }
    all.insert(all.end(), ids.begin(), ids.end());
  }
  for (const Id id : all) {
    for (const auto& [key, value] : statement.properties) {
      const auto& known = map_.find(id)->properties;
      const auto found = known.find(key);
      if (found != known.end() && found->second != value && !statement.correction) {
        return askBack(statement, "contradiction",
                       {{"known", name(id) + " " + whereIs(id)}, {"said", statement.text}});
      }
    }
  }
  std::vector<std::string> told;
  for (const Id id : all) {
    for (const auto& [key, value] : statement.properties) map_.find(id)->properties[key] = value;
    told.push_back(name(id));
  }
  subjects_ = all;
  map_.stamp = std::max(map_.stamp, stamp_);
  ObjectReply out = reply(ReplyKind::kDone, "done", {{"what", list(told)}});
  out.objects = all;
  return out;
}

ObjectReply FillMap::forget(const ObjectStatement& statement) {
  std::vector<Id> all;
  std::vector<std::string> names;
  for (const ObjectPhrase& said : statement.objects) {
    const std::vector<Id> ids = resolve(said, place_);
    if (ids.empty()) return reply(ReplyKind::kQuestion, "unknown", {{"what", said.text}});
    if (ids.size() > 1 && !said.plural && said.reference != "them") {
      return askBack(statement, "which_one",
                     {{"count", std::to_string(ids.size())}, {"what", said.text}});
    }
    all.insert(all.end(), ids.begin(), ids.end());
  }
  for (const Id id : all) {
    names.push_back(name(id));
    map_.remove(id);
  }
  subjects_.clear();
  map_.stamp = std::max(map_.stamp, stamp_);
  return reply(ReplyKind::kDone, "forgotten", {{"what", list(names)}});
}

ObjectReply FillMap::answer(const ObjectStatement& statement) {
  if (!pending_) return reply(ReplyKind::kDone, "nothing_asked");
  const Pending pending = std::move(*pending_);
  pending_.reset();
  if (statement.intent == "place_answer") {
    ObjectStatement again = pending.statements.front();
    again.place = statement.place;
    return tell(again);
  }
  if (pending.for_count && (statement.intent == "yes" || statement.count)) {
    // "Some": at least two, and no more are known of.
    ObjectStatement again = pending.statements.front();
    for (ObjectPhrase& said : again.objects) {
      if (!said.plural || said.count_said || !said.reference.empty()) continue;
      said.count = statement.count.value_or(2);
      said.count_said = true;
      break;
    }
    return tell(again);
  }
  if (statement.intent == "yes" && !pending.for_place) {
    ObjectStatement again = pending.statements.front();
    again.correction = true;
    return again.intent == "is_like" ? describe(again) : tell(again);
  }
  return reply(ReplyKind::kDone, "kept");
}

}  // namespace hyselam_objects

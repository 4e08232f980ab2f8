#include "object_statements.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"
#include "object_phrases.hpp"

namespace hyselam_objects {
namespace {

using hyselam_topo::SaidName;
using hyselam_topo::Slot;
using hyselam_topo::Utterance;
using hyselam_topo::UtteranceKind;

/// "under the newspaper", "between the desk and the door", "in front of room 3".
struct SaidRelation {
  RelationWord word = RelationWord::kNear;
  std::vector<ObjectPhrase> landmarks;
  std::vector<SaidName> rooms;
  bool of_landmark = false;  ///< it tells where the landmark before it is
};

class StatementReader {
 public:
  StatementReader(const ObjectWords& words, const hyselam_topo::Grammar& grammar,
                  const Utterance& utterance, const std::string& text)
      : words_(words), grammar_(grammar), u_(utterance), text_(text) {}

  std::vector<ObjectStatement> read() {
    ObjectStatement base = plain();
    const std::string wrong = u_.understood() ? whatIsWrong(base) : "";
    if (!wrong.empty()) return {refused(wrong)};
    // Of a denial only the first relation counts.
    const bool asks = base.kind != UtteranceKind::kStatement || base.intent == "not_there";
    const bool is_whole = asks || (base.properties.empty() && base.owner.empty()) || !base.place;
    if (relations_.empty() && is_whole) return {base};
    return asks ? std::vector<ObjectStatement>{asked(base)} : split(base);
  }

 private:
  /// All relations of a question narrow what is asked for.
  ObjectStatement asked(const ObjectStatement& base) const {
    ObjectStatement out = withRelation(base, relations_.front(), 0);
    if (base.kind != UtteranceKind::kQuestion) return out;
    for (std::size_t i = 0; i < relations_.size(); ++i) {
      const SaidRelation& each = relations_[i];
      for (std::size_t k = i == 0 ? 1 : 0; k < each.landmarks.size(); ++k) {
        out.further.push_back({each.word, each.landmarks[k], each.of_landmark});
      }
    }
    return out;
  }

  ObjectStatement plain() {
    ObjectStatement out;
    out.kind = u_.kind;
    out.intent = u_.intent;
    out.language = words_.language;
    out.moved = u_.word("moved") == "yes";
    out.correction = u_.correction || out.moved;
    if (const auto count = u_.number("count")) out.count = static_cast<int>(std::min(*count, 1e3));
    if (const auto word = hyselam::parseNumber(u_.word("some")))
      out.count = static_cast<int>(*word);
    out.text = u_.text;
    out.reason = u_.reason;
    out.reason_code = u_.reason_code;
    out.suggestion = u_.suggestion;
    out.suggests_meaning = u_.suggests_meaning;
    out.suggests_own_words = u_.suggests_own_words;
    out.alternatives = u_.alternatives;
    out.left_out = u_.left_out;
    for (const Slot& slot : u_.slots) {
      if (slot.type == "constant") out.words[slot.name] = slot.word;
    }
    for (const SaidName& name : u_.names("objects")) {
      out.objects.push_back(phraseOf(words_, name, text_));
    }
    for (const SaidName& name : u_.names("such")) describeTheOne(name, &out);
    if (const auto tens = hyselam::parseNumber(u_.word("tens")); tens && !out.objects.empty()) {
      ObjectPhrase& counted = out.objects.front();  // "vinte e uma cadeiras"
      counted.count += static_cast<int>(*tens);
      counted.has_count = true;
    }
    if (const auto amount = hyselam::parseNumber(u_.word("amount"));
        amount && !out.objects.empty()) {
      out.objects.front().count = static_cast<int>(*amount);  // "half a dozen cups"
      out.objects.front().has_count = true;
    }
    for (const SaidName& name : u_.names("place")) out.place = name;
    if (u_.word("where") == "here") {
      SaidName here;
      here.text = here.reference = "here";
      out.place = here;
    }
    for (const SaidName& name : u_.names("owner")) {
      out.owner = name.reference.empty() ? name.text : name.reference;
    }
    if (u_.word("possessive") == "yes") {
      const std::size_t mark = out.owner.size() > 2 ? out.owner.size() - 2 : 0;
      out.owner =
          mark > 0 && out.owner.compare(mark, 2, "'s") == 0 ? out.owner.substr(0, mark) : "";
      if (out.owner.empty() && !words_.head_first) possessive_is_missing_ = true;
    }
    if (!u_.word("material").empty()) out.properties["material"] = u_.word("material");
    for (const SaidName& name : u_.names("properties")) {
      const auto found = words_.properties.find(lowerCase(name.text));
      if (found != words_.properties.end()) out.properties.insert(found->second);
    }
    readRelations(&out);
    readAccents(&out);
    takeFrom(&out);
    if (out.moved) dropOrigin(&out);
    return out;
  }

  /// "O copo está na secretária": a desk. Without its accent it is an office, and the grammar,
  /// which forgives accents, reads the one for the other.
  void readAccents(ObjectStatement* out) {
    if (!out->place || !relations_.empty() || out->intent != "is_at") return;
    const std::string said = lowerCase(out->place->text);
    const bool thing = words_.things.count(said) != 0 && words_.place_kinds.count(said) == 0 &&
                       words_.place_kinds.count(hyselam::utf8Fold(said)) != 0;
    if (!thing) return;
    SaidRelation relation;
    relation.word = RelationWord::kIn;
    relation.landmarks = {phraseOf(words_, *out->place, text_)};
    out->place.reset();
    onTop(&relation);
    relations_.push_back(std::move(relation));
  }

  /// "a vermelha está na gaveta": of the kind that was mentioned last.
  void describeTheOne(const SaidName& said, ObjectStatement* out) const {
    const auto property = words_.properties.find(lowerCase(said.text));
    if (property == words_.properties.end()) return;
    for (ObjectPhrase& phrase : out->objects) {
      if (phrase.reference != "the_one") continue;
      phrase.reference.clear();
      phrase.one = phrase.definite = true;
      phrase.properties.insert(property->second);
      phrase.text = said.text;
      phrase.form = words_.articleForm(wordBefore(text_, said.range.begin));
    }
  }

  /// "a mesa da sala": a table, in the room. "Of the", not "de": "mesa de sala" is a kind of table.
  bool takePlaceBehind(SaidName* name, std::optional<SaidName>* place) const {
    if (!words_.head_first) return takePlaceOf(name, place);
    const std::vector<std::string> all = splitWords(name->text);
    for (std::size_t i = 1; i + 1 < all.size(); ++i) {
      const auto known = words_.no_things.find(lowerCase(all[i + 1]));
      const bool of_the = all[i] == "da" || all[i] == "do";
      if (!of_the || known == words_.no_things.end() || known->second != "place") continue;
      std::string thing, where;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (k == i) continue;
        std::string& part = k < i ? thing : where;
        part += (part.empty() ? "" : " ") + all[k];
      }
      name->text = thing;
      if (!*place) {
        place->emplace();
        (*place)->text = where;
      }
      return true;
    }
    return false;
  }

  /// "the cabinet of the workshop"
  bool takePlaceOf(SaidName* name, std::optional<SaidName>* place) const {
    const std::size_t at = lowerCase(name->text).find(" of ");
    if (at == std::string::npos) return false;
    std::string where = name->text.substr(at + 4);
    const std::size_t space = where.find(' ');
    if (space != std::string::npos &&
        words_.articles.count(lowerCase(where.substr(0, space))) != 0) {
      where.erase(0, space + 1);
    }
    const auto known = words_.no_things.find(lowerCase(words_.headOf(where)));
    if (known == words_.no_things.end() || known->second != "place") return false;
    name->text.erase(at);
    if (!*place) {
      place->emplace();
      (*place)->text = where;
    }
    return true;
  }

  /// "Tirei o copo da mesa": from the table, not a cup of tables.
  void takeFrom(ObjectStatement* out) {
    if (!words_.head_first || out->intent != "forget_object" || out->objects.size() != 1) return;
    ObjectPhrase& phrase = out->objects.front();
    for (const char* const of : {" da ", " do "}) {
      const std::size_t at = phrase.kind.find(of);
      if (at == std::string::npos || !words_.isNoun(phrase.kind.substr(at + 4))) continue;
      SaidRelation relation;
      relation.word = RelationWord::kOn;
      ObjectPhrase landmark;
      landmark.text = phrase.kind.substr(at + 4);
      landmark.kind = words_.kindOf(landmark.text).kind;
      landmark.definite = landmark.known_noun = true;
      relation.landmarks = {landmark};
      relations_ = {relation};
      phrase.kind = phrase.text = phrase.kind.substr(0, at);
      out->kind = UtteranceKind::kStatement;
      out->intent = "not_there";
      return;
    }
  }

  /// "Mudei o copo da mesa para a estante": the table tells where it was.
  void dropOrigin(ObjectStatement* out) const {
    if (!words_.head_first || out->objects.size() != 1) return;
    ObjectPhrase& phrase = out->objects.front();
    for (const char* const of : {" da ", " do ", " das ", " dos "}) {
      const std::size_t at = phrase.kind.find(of);
      if (at == std::string::npos || words_.things.count(lowerCase(phrase.kind)) != 0) continue;
      const std::string from = phrase.kind.substr(at + std::string(of).size());
      const auto no_thing = words_.no_things.find(lowerCase(words_.headOf(from)));
      const bool is_place = no_thing != words_.no_things.end() && no_thing->second == "place";
      const std::string kind = words_.kindOf(from).kind;
      if (!is_place && words_.tops.count(kind) == 0 && words_.hollows.count(kind) == 0) continue;
      phrase.kind = phrase.text = phrase.kind.substr(0, at);
      return;
    }
  }

  /// "the kitchen door", "a porta da cozinha": a door, in the kitchen. False for what is no part of
  /// a building.
  bool takePlaceOfPart(SaidName* name, std::optional<SaidName>* place) const {
    const std::string head = words_.headOf(name->text);
    if (words_.structure.count(lowerCase(head)) == 0) return false;
    std::vector<std::string> rest = splitWords(name->text);
    rest.erase(std::find(rest.begin(), rest.end(), head));
    while (!rest.empty() && words_.of.count(lowerCase(rest.front())) != 0) rest.erase(rest.begin());
    std::string where;
    for (const std::string& word : rest) where += (where.empty() ? "" : " ") + word;
    const auto known = words_.no_things.find(lowerCase(words_.headOf(where)));
    if (known == words_.no_things.end() || known->second != "place") return true;
    name->text = head;
    if (!*place) {
      place->emplace();
      (*place)->text = where;
    }
    return true;
  }

  void readRelations(ObjectStatement* out) {
    constexpr std::array<const char*, 3> kSuffixes{"", "_b", "_c"};
    const Slot* before = nullptr;
    for (const char* const suffix : kSuffixes) {
      const Slot* word = u_.find(std::string("relation") + suffix);
      const Slot* landmark = u_.find(std::string("landmark") + suffix);
      if (landmark == nullptr) landmark = u_.find(std::string("box") + suffix);
      const Slot* room = u_.find(std::string("room") + suffix);
      if (word == nullptr || (landmark == nullptr && room == nullptr)) continue;
      const auto meaning = relationWordFromString(word->word);
      if (!meaning) continue;
      SaidRelation relation;
      relation.word = *meaning;
      for (const Slot* slot : {landmark, room}) {
        if (slot == nullptr) continue;
        for (const SaidName& name : slot->names) {
          SaidName thing = name;
          const bool is_part =
              takePlaceOfPart(&thing, &out->place) || takePlaceBehind(&thing, &out->place);
          const bool is_thing = slot == landmark || is_part;
          if (is_thing) relation.landmarks.push_back(phraseOf(words_, thing, text_));
          if (!is_thing) relation.rooms.push_back(name);
        }
      }
      relation.of_landmark =
          before != nullptr && isOfLandmark(*before, *landmark_or(landmark, room));
      onTop(&relation);
      relations_.push_back(std::move(relation));
      before = landmark;
    }
  }

  static const Slot* landmark_or(const Slot* landmark, const Slot* room) {
    return landmark != nullptr ? landmark : room;
  }

  /// "under the paper on the table": on the table lies the paper. Behind a comma, and behind what
  /// has no place of its own ("on the floor under the table"), the things themselves are meant.
  bool isOfLandmark(const Slot& before, const Slot& now) const {
    const std::size_t begin = before.range.end, end = now.range.begin;
    if (end > begin && text_.substr(begin, end - begin).find(',') != std::string::npos) {
      return false;
    }
    const SaidRelation& last = relations_.back();
    if (last.landmarks.size() != 1) return false;
    static const std::set<std::string> kAnywhere{"floor", "wall",   "ceiling", "corner",
                                                 "chão",  "parede", "teto",    "canto"};
    return kAnywhere.count(last.landmarks.front().kind) == 0;
  }

  /// Where one word means both: what is "na mesa" lies on the table.
  void onTop(SaidRelation* relation) const {
    if (relation->landmarks.size() != 1) return;
    if (u_.word("to") == "yes") {
      // "I took the cup to the table", but "the chair to the table"
      const std::vector<SaidName> moved = u_.names("objects");
      const bool small = moved.empty() || !isTop(phraseOf(words_, moved.front(), text_));
      if (isTop(relation->landmarks.front()) && small) relation->word = RelationWord::kOn;
      if (isHollow(relation->landmarks.front()) && small) relation->word = RelationWord::kIn;
      return;
    }
    if (relation->word != RelationWord::kIn) return;
    const bool said_so = words_.head_first || u_.word("has") == "yes";
    if (isTop(relation->landmarks.front()) && said_so) relation->word = RelationWord::kOn;
  }

  bool isTop(const ObjectPhrase& phrase) const {
    return words_.tops.count(phrase.kind) != 0 ||
           words_.tops.count(lowerCase(words_.headOf(phrase.kind))) != 0;
  }

  bool isHollow(const ObjectPhrase& phrase) const {
    return words_.hollows.count(lowerCase(words_.headOf(phrase.kind))) != 0;
  }

  std::string whatIsWrong(const ObjectStatement& base) {
    if (u_.kind == UtteranceKind::kAnswer) return "";
    if (u_.names("place").size() > 1) return "two_places";
    if (possessive_is_missing_) return "no_pattern";
    for (const char* const slot : {"place", "room"}) {
      for (const SaidName& name : u_.names(slot)) {
        if (name.speaker) return "whose|" + name.text;
      }
    }
    if (u_.kind == UtteranceKind::kQuestion) return "";
    for (const ObjectPhrase& phrase : base.objects) {
      const std::string wrong = whyNoThing(words_, phrase, false);
      if (!wrong.empty()) return wrong + "|" + phrase.text;
    }
    for (const SaidRelation& relation : relations_) {
      for (const ObjectPhrase& phrase : relation.landmarks) {
        const std::string wrong = whyNoThing(words_, phrase, true);
        if (!wrong.empty()) return wrong + "|" + phrase.text;
      }
    }
    return "";
  }

  ObjectStatement refused(const std::string& code_and_word) const {
    const std::size_t bar = code_and_word.find('|');
    ObjectStatement out;
    out.language = words_.language;
    out.text = u_.text;
    out.reason_code = code_and_word.substr(0, bar);
    const std::string word = bar == std::string::npos ? u_.text : code_and_word.substr(bar + 1);
    out.reason = grammar_.reason(out.reason_code, word);
    return out;
  }

  static ObjectStatement withRelation(ObjectStatement statement, const SaidRelation& relation,
                                      std::size_t landmark) {
    statement.relation = relation.word;
    if (!relation.landmarks.empty()) statement.landmark = relation.landmarks[landmark];
    if (!relation.rooms.empty()) statement.room = relation.rooms[landmark];
    return statement;
  }

  /// The same things again: "..., and it is behind the door".
  static ObjectStatement again(const ObjectStatement& base) {
    ObjectStatement out = base;
    ObjectPhrase same;
    same.reference = "same";
    same.definite = !base.objects.empty() && base.objects.front().definite;
    same.plural = true;
    out.objects = {same};
    out.place.reset();
    out.continues = true;
    return out;
  }

  /// "The cup on the desk is blue": first where it is, then what it is like.
  std::vector<ObjectStatement> splitProperties(const ObjectStatement& base) const {
    ObjectStatement where = base;
    where.intent = "exist";
    where.properties.clear();
    where.owner.clear();
    where.background = true;
    std::vector<ObjectStatement> out = split(where);
    for (ObjectStatement& each : out) each.background = true;
    ObjectStatement like = again(base);
    out.push_back(like);
    return out;
  }

  std::vector<ObjectStatement> split(const ObjectStatement& base) const {
    if (!base.properties.empty() || !base.owner.empty()) return splitProperties(base);
    std::vector<ObjectStatement> out;
    // Where landmarks are, the last one first: it alone is at the place that was stated.
    for (std::size_t i = relations_.size(); i-- > 1;) {
      if (!relations_[i].of_landmark) continue;
      ObjectStatement landmark = base;
      landmark.intent = "exist";
      landmark.objects = relations_[i - 1].landmarks;
      landmark.background = landmark.is_landmark = true;
      landmark.correction = landmark.moved = false;
      if (!out.empty()) landmark.place.reset();
      landmark.continues = !out.empty();
      out.push_back(withRelation(landmark, relations_[i], 0));
    }
    if (relations_.empty()) return {base};
    bool is_first = true;
    for (const SaidRelation& relation : relations_) {
      if (relation.of_landmark) continue;
      const std::size_t count = std::max(relation.landmarks.size(), relation.rooms.size());
      for (std::size_t k = 0; k < count; ++k) {
        ObjectStatement each = is_first ? base : again(base);
        each.continues = !out.empty();
        if (each.continues && is_first) each.place.reset();
        out.push_back(withRelation(each, relation, k));
        is_first = false;
      }
    }
    return out;
  }

  const ObjectWords& words_;
  const hyselam_topo::Grammar& grammar_;
  const Utterance& u_;
  const std::string& text_;
  std::vector<SaidRelation> relations_;
  bool possessive_is_missing_ = false;  ///< "the cup is Susan"
};

}  // namespace

std::vector<ObjectStatement> statementsOf(const ObjectWords& words,
                                          const hyselam_topo::Grammar& grammar,
                                          const Utterance& utterance, const std::string& text) {
  return StatementReader(words, grammar, utterance, text).read();
}

}  // namespace hyselam_objects

#include "object_phrases.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/numbers.hpp"

namespace hyselam_objects {
namespace {

constexpr int kAll = -1;  // of ObjectWords::quantities
constexpr char kSpeaker[] = "speaker";

bool startsUpper(const std::string& word) {
  return !word.empty() && ((word[0] >= 'A' && word[0] <= 'Z') || lowerCase(word) != word);
}

}  // namespace

std::string wordBefore(const std::string& text, std::size_t at) {
  while (at > 0 && text[at - 1] == ' ') --at;
  std::size_t begin = at;
  while (begin > 0 && text[begin - 1] != ' ' && text[begin - 1] != ',') --begin;
  return lowerCase(text.substr(begin, at - begin));
}

namespace {

class PhraseReader {
 public:
  PhraseReader(const ObjectWords& words, const hyselam_topo::SaidName& name)
      : words_(words), rest_(splitWords(name.text)) {
    out_.text = name.text;
    if (name.speaker) {
      out_.properties["owner"] = kSpeaker;
      out_.definite = true;
    }
  }

  ObjectPhrase read(const std::string& before) {
    out_.definite = out_.definite || words_.definite.count(before) != 0;
    out_.bare = !out_.definite && words_.articles.count(before) == 0;
    takeQuantity();
    if (words_.properties_after) takePropertiesBehind();
    takeOwner();
    takeLeading();
    takeNoun();
    return out_;
  }

 private:
  std::string lower(std::size_t i) const { return lowerCase(rest_[i]); }
  void drop(std::size_t count) {
    rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(count));
  }

  void setCount(int count) {
    out_.count = count;
    out_.has_count = true;
    out_.bare = false;
  }

  /// "a couple of", "half a dozen", "all the".
  void takeQuantity() {
    constexpr std::size_t kLongest = 4;
    for (std::size_t length = std::min(kLongest, rest_.size() - 1); length > 0; --length) {
      std::string phrase;
      for (std::size_t i = 0; i < length; ++i) phrase += (i > 0 ? " " : "") + lower(i);
      const auto found = words_.quantities.find(phrase);
      if (found == words_.quantities.end()) continue;
      drop(length);
      out_.bare = false;
      if (found->second == kAll) {
        out_.definite = true;
      } else if (found->second == 0) {
        out_.some = true;
        out_.definite = false;
      } else {
        setCount(found->second);
        if (phrase == "both" || phrase == "ambos" || phrase == "ambas") out_.definite = true;
      }
      while (rest_.size() > 1 && words_.of.count(lower(0)) != 0) drop(1);
      if (rest_.size() > 1 && words_.articles.count(lower(0)) != 0) {
        out_.definite = out_.definite || words_.definite.count(lower(0)) != 0;
        drop(1);
      }
      return;
    }
  }

  /// "copo vermelho pequeno"
  void takePropertiesBehind() {
    for (; rest_.size() > 1; rest_.pop_back()) {
      // "de madeira", "de baixo"
      const bool made = rest_.size() > 2 && words_.of.count(lower(rest_.size() - 2)) != 0;
      auto property =
          made ? words_.properties.find(lower(rest_.size() - 2) + " " + lowerCase(rest_.back()))
               : words_.properties.end();
      if (property != words_.properties.end()) {
        out_.properties[property->second.first] = property->second.second;
        rest_.pop_back();
        continue;
      }
      property = words_.properties.find(lowerCase(rest_.back()));
      if (property == words_.properties.end() || isOfInnerNoun(property->second.second)) return;
      out_.properties[property->second.first] = property->second.second;
    }
  }

  /// "prateleira do armário amarelo": by its gender the last word tells of the cupboard alone.
  bool isOfInnerNoun(const std::string& property) const {
    constexpr std::size_t kForms = 4;  // masculine and feminine, then both in the plural
    const auto forms = words_.property_words.find(property);
    if (forms == words_.property_words.end() || forms->second.size() != kForms) return false;
    const auto form =
        std::find(forms->second.begin(), forms->second.end(), lowerCase(rest_.back()));
    if (form == forms->second.end()) return false;
    const bool feminine = (form - forms->second.begin()) % 2 == 1;
    for (std::size_t i = rest_.size() - 1; i-- > 1;) {
      if (words_.of.count(lower(i)) == 0 || i + 2 >= rest_.size()) continue;
      const auto isFeminine = [&](std::size_t begin, std::size_t end) {
        return words_.formOf(words_.kindOf(joined(begin, end)).kind) == "f";
      };
      return isFeminine(0, i) != feminine && isFeminine(i + 1, rest_.size() - 1) == feminine;
    }
    return false;
  }

  void setOwner(const std::string& owner) {
    out_.properties["owner"] = owner;
    out_.definite = true;
    out_.bare = false;
  }

  std::string joined(std::size_t begin, std::size_t end) const {
    std::string text;
    for (std::size_t i = begin; i < end; ++i) text += (i > begin ? " " : "") + rest_[i];
    return text;
  }

  /// "John Smith's mug"; "a caneca do João", "a mala do hóspede".
  void takeOwner() {
    constexpr std::size_t kLongestOwner = 3;
    for (std::size_t i = 0; i + 1 < rest_.size() && i < kLongestOwner; ++i) {
      const std::size_t mark = rest_[i].find("'s");
      if (mark == std::string::npos || mark == 0 || mark + 2 != rest_[i].size()) continue;
      rest_[i].erase(mark);
      setOwner(joined(0, i + 1));
      drop(i + 1);
      return;
    }
    for (std::size_t i = 1; i + 1 < rest_.size(); ++i) {
      if (words_.of.count(lower(i)) == 0) continue;
      std::size_t begin = i + 1;
      if (begin + 1 < rest_.size() && words_.articles.count(lower(begin)) != 0) ++begin;
      const auto person = words_.no_things.find(lower(begin));
      const bool is_person = person != words_.no_things.end() && person->second == "person";
      const bool is_name = startsUpper(rest_[begin]) && !words_.isNoun(rest_[begin]);
      if (!is_name && !is_person) continue;
      setOwner(joined(begin, rest_.size()));
      rest_.resize(i);
      return;
    }
  }

  /// Numbers, "other", and properties before the noun.
  void takeLeading() {
    std::size_t at = 0;
    for (; at + 1 < rest_.size(); ++at) {
      const std::string word = lower(at);
      // "first aid kit", "high chair", but "two glass jars"
      const bool is_noun = words_.numberOf(word) == 0 &&
                           words_.things.count(lowerCase(joined(at, rest_.size()))) != 0;
      const bool is_property = words_.properties.count(word) != 0;
      if (is_noun && is_property) break;
      const auto property = words_.properties.find(word);
      const auto digits = hyselam::parseNumber(word);
      if (const int number = words_.numberOf(word); number > 0) {
        setCount(out_.has_count && out_.count >= 20 && number < 10 ? out_.count + number : number);
      } else if (digits && *digits >= 1.0 && *digits <= 1000.0) {
        setCount(static_cast<int>(*digits));
      } else if (words_.another.count(word) != 0) {
        (out_.definite && !out_.has_count ? out_.other : out_.another) = true;
        out_.bare = false;
      } else if (property != words_.properties.end()) {
        out_.properties[property->second.first] = property->second.second;
      } else {
        break;
      }
    }
    drop(at);
  }

  void takeNoun() {
    std::string noun = joined(0, rest_.size());
    out_.capital =
        !out_.bare && startsUpper(rest_.front()) && !startsUpper(rest_.front().substr(1));
    if (rest_.size() == 1 && words_.another.count(lower(0)) != 0) {  // "the other", "outra"
      out_.one = true;
      out_.form = words_.articleForm(lower(0));
      (out_.definite ? out_.other : out_.another) = true;
      return;
    }
    if (words_.one_words.count(lowerCase(noun)) != 0) {
      out_.one = true;
      return;
    }
    const auto digits = hyselam::parseNumber(noun);  // "the other 2"
    if (digits && *digits >= 1.0 && *digits <= 1000.0) {
      out_.one = true;
      setCount(static_cast<int>(*digits));
      return;
    }
    const std::size_t mark = noun.size() > 2 ? noun.size() - 2 : 0;
    if (mark > 0 && noun.compare(mark, 2, "'s") == 0) noun.erase(mark);  // "the desk's got"
    const NounKind found = words_.kindOf(noun);
    out_.kind = found.kind;
    out_.plural = found.plural || (out_.some && words_.mass.count(lowerCase(noun)) == 0);
    out_.known_noun = words_.isNoun(noun) || words_.isNoun(found.kind);
    if (out_.some && words_.mass.count(lowerCase(noun)) != 0) out_.some = false;
  }

  const ObjectWords& words_;
  std::vector<std::string> rest_;
  ObjectPhrase out_;
};

}  // namespace

ObjectPhrase phraseOf(const ObjectWords& words, const hyselam_topo::SaidName& name,
                      const std::string& text) {
  if (!name.reference.empty()) {
    ObjectPhrase out;
    out.text = name.text;
    out.reference = name.reference;
    out.definite = true;
    if (name.reference == "mine") {  // another one, of the kind mentioned last
      out.reference.clear();
      out.one = out.other = true;
      out.form = words.articleForm(name.text.substr(0, name.text.find(' ')));
      out.properties["owner"] = kSpeaker;
    }
    return out;
  }
  return PhraseReader(words, name).read(wordBefore(text, name.range.begin));
}

std::string whyNoThing(const ObjectWords& words, const ObjectPhrase& phrase, bool is_landmark) {
  if (!phrase.reference.empty() || phrase.one) return "";
  const std::string head = lowerCase(words.headOf(phrase.kind));
  if (is_landmark && words.structure.count(head) != 0) return "";
  const auto found = words.no_things.find(head);
  if (found != words.no_things.end() && !words.isNoun(phrase.kind)) return found->second;
  // "Two buckets, one red, one blue": of what was said before, no things of their own.
  const bool only_property = words.properties.count(lowerCase(phrase.kind)) != 0;
  if (only_property && !phrase.definite && !words.isNoun(phrase.kind)) return "vague";
  // In English a capital may as well be that of a brand: "the Xerox".
  if (words.head_first && phrase.capital && !phrase.known_noun) return "person";
  const bool clear = phrase.known_noun || phrase.plural || !phrase.bare;
  return clear ? "" : "bare";
}

}  // namespace hyselam_objects

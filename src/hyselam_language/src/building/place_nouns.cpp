// What kind of thing a name is the name of: its head noun.
#include <algorithm>
#include <cctype>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "name_words.hpp"

namespace hyselam_topo {
namespace {

using language::NameType;
using Words = std::vector<std::string>;

constexpr std::size_t kLongestNoun = 3;  // words

std::string phrase(const Words& words, std::size_t begin, std::size_t end) {
  std::string all;
  for (std::size_t i = begin; i < end; ++i) all += (i > begin ? " " : "") + words[i];
  return all;
}

bool isNoun(const std::string& text, const NameType& type) {
  if (type.nouns.count(text) != 0 || type.heads.count(text) != 0 || type.titles.count(text) != 0) {
    return true;
  }
  return std::any_of(type.plurals.begin(), type.plurals.end(),
                     [&](const auto& plural) { return plural.first == text; });
}

/// Words [begin, end) of the head noun; empty without one. "the room of Tom": the last noun before
/// a word that joins, or the first one of the name.
std::pair<std::size_t, std::size_t> headRange(const Words& words, const NameType& type) {
  const auto joiner = std::find_if(words.begin(), words.end(), [&](const std::string& word) {
    return type.joiners.count(word) != 0;
  });
  const auto own = static_cast<std::size_t>(joiner - words.begin());
  const std::size_t length = type.head_first ? words.size() : own;
  for (std::size_t n = std::min(kLongestNoun, length); n > 0; --n) {
    const std::size_t begin = type.head_first ? 0 : length - n;
    if (isNoun(phrase(words, begin, begin + n), type)) return {begin, begin + n};
  }
  // "room Mozart", "room I-109": the noun is a title of what follows.
  if (!type.head_first && length > 1 && isNoun(words[0], type)) return {0, 1};
  return {0, 0};
}

/// Every word but the first is a name of its own ("Mozart"), or a code.
bool isTitled(const std::string& name) {
  std::size_t at = name.find(' ');
  if (at == std::string::npos) return false;
  for (; at != std::string::npos; at = name.find(' ', at + 1)) {
    const char c = at + 1 < name.size() ? name[at + 1] : ' ';
    if (!std::isupper(static_cast<unsigned char>(c))) return false;
  }
  return true;
}

}  // namespace

std::string PlaceNames::headOf(const std::string& name) const {
  const Words words = wordsOfName(name);
  for (const Grammar& grammar : grammars_) {
    const NameType* type = grammar.compiled().nameType(type_);
    if (type == nullptr) continue;
    const auto [begin, end] = headRange(words, *type);
    if (end > begin) return phrase(words, begin, end);
  }
  return "";
}

bool PlaceNames::isOfPlace(const std::string& name) const {
  const Words words = wordsOfName(name);
  if (words.empty()) return false;
  const bool code = std::any_of(words.begin(), words.end(), hasDigit) || words.back().size() == 1;
  if (code) return true;
  const auto endsIn = [&](const std::string& end) {
    return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  if (endsIn("'s") || endsIn("s'") || endsIn("\xe2\x80\x99s")) return true;
  for (const Grammar& grammar : grammars_) {
    const NameType* type = grammar.compiled().nameType(type_);
    if (type == nullptr) continue;
    const auto [begin, end] = headRange(words, *type);
    if (end == begin) continue;
    const bool is_title = !type->head_first && begin == 0 && end == 1 && words.size() > 1;
    const bool joined = is_title && type->joiners.count(words[1]) != 0;
    const bool number = is_title && grammar.compiled().number_words.count(words[1]) != 0;
    if (!is_title || joined || number || isTitled(name)) return true;
  }
  return false;
}

bool PlaceNames::isPlainRoom(const std::string& name) const {
  const std::string head = headOf(name);
  if (head.empty()) return true;
  return std::any_of(grammars_.begin(), grammars_.end(), [&](const Grammar& grammar) {
    const NameType* type = grammar.compiled().nameType(type_);
    if (type == nullptr) return false;
    const auto title = type->titles.find(head);
    return type->generic.count(head) != 0 || type->heads.count(head) != 0 ||
           (title != type->titles.end() && title->second == "room");
  });
}

std::string PlaceNames::singular(const std::string& name) const {
  for (const Grammar& grammar : grammars_) {
    const NameType* type = grammar.compiled().nameType(type_);
    if (type == nullptr) continue;
    // The word that tells the number: the last one, or the first in "casas de banho".
    const std::size_t space = type->head_first ? name.find(' ') : name.rfind(' ');
    const bool alone = space == std::string::npos;
    const std::string before = type->head_first || alone ? "" : name.substr(0, space + 1);
    const std::string after = type->head_first && !alone ? name.substr(space) : "";
    const std::string word = name.substr(before.size(), name.size() - before.size() - after.size());
    const std::string folded = hyselam::utf8Fold(word);
    const auto plural = type->plurals.find(folded);
    if (plural != type->plurals.end()) return before + plural->second + after;
    if (folded.size() < 3 || folded.back() != 's') continue;
    const std::string one = word.substr(0, word.size() - 1);
    const std::string head = hyselam::utf8Fold(one);
    const std::string whole = hyselam::utf8Fold(before + one + after);
    if (isNoun(head, *type) || isNoun(whole, *type)) return before + one + after;
  }
  return name;
}

}  // namespace hyselam_topo

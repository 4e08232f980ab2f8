#include "hyselam_language/building/place_names.hpp"

#include <algorithm>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/utf8.hpp"
#include "name_words.hpp"

namespace hyselam_topo {
namespace {

using language::NameType;

std::string joined(const std::vector<std::string>& words, std::size_t from = 0) {
  std::string all;
  for (std::size_t i = from; i < words.size(); ++i) all += words[i];
  return all;
}

using Types = std::vector<const NameType*>;

/// "office of Tom" is "Tom's office", in languages whose head comes last; not of codes: "room of
/// A".
void ownerFirst(const Types& types, std::vector<std::string>* words) {
  for (std::size_t k = 1; k + 1 < words->size(); ++k) {
    const std::string& word = (*words)[k];
    const auto type = std::find_if(types.begin(), types.end(), [&](const NameType* each) {
      return !each->head_first && each->joiners.count(word) != 0 &&
             each->part_joiners.count(word) != 0;
    });
    if (type == types.end()) continue;
    std::vector<std::string> owner(words->begin() + static_cast<std::ptrdiff_t>(k) + 1,
                                   words->end());
    if (owner.size() > 1 && (*type)->isArticle(owner.front())) owner.erase(owner.begin());
    if (owner.back().size() < 3 || hasDigit(owner.back())) return;
    words->resize(k);
    words->insert(words->begin(), owner.begin(), owner.end());
    return;
  }
}

/// "gabinete do Rui" is "gabinete de Rui".
void dropJoiners(const Types& types, std::vector<std::string>* words) {
  if (words->size() < 3) return;
  const auto joins = [&](const std::string& word) {
    return std::any_of(types.begin(), types.end(),
                       [&](const NameType* type) { return type->joiners.count(word) != 0; });
  };
  words->erase(std::remove_if(words->begin() + 1, words->end() - 1, joins), words->end() - 1);
}

}  // namespace

std::vector<std::string> wordsOfName(const std::string& name) {
  const std::string text = hyselam::utf8Fold(name);
  std::vector<std::string> words;
  bool in_word = false;
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = std::max<std::size_t>(hyselam::utf8CharacterAt(text, i, &code), 1);
    if (hyselam::isUnicodeLetterOrDigit(code)) {
      if (!in_word) words.emplace_back();
      words.back().append(text, i, length);
      in_word = true;
    } else if (code == '\'' && in_word) {
      const bool possessive =
          text.compare(i, 2, "'s") == 0 && (i + 2 == text.size() || text[i + 2] == ' ');
      if (possessive) ++i;
      // Other apostrophes vanish within their word.
      in_word = !possessive;
    } else {
      in_word = false;
    }
    i += length;
  }
  return words;
}

SameName compare(const NameKey& a, const NameKey& b) {
  if (a.full == b.full) return SameName::kYes;
  if (!a.kind.empty() && a.kind == b.kind && a.language != b.language) return SameName::kPerhaps;
  if (a.core.empty() || a.core != b.core) return SameName::kNo;
  if (a.title == b.title) return SameName::kYes;
  return a.title.empty() || b.title.empty() ? SameName::kPerhaps : SameName::kNo;
}

PlaceNames::PlaceNames(std::vector<Grammar> grammars, std::string type)
    : grammars_(std::move(grammars)), type_(std::move(type)) {}

NameKey PlaceNames::key(const std::string& name) const {
  std::vector<std::string> words = wordsOfName(name);
  NameKey key;
  std::vector<const NameType*> types;
  for (const Grammar& grammar : grammars_) {
    if (const NameType* type = grammar.compiled().nameType(type_)) types.push_back(type);
  }
  const auto anyType = [&](auto&& holds) { return std::any_of(types.begin(), types.end(), holds); };
  // "A cozinha", but "A wing": an article of one letter stands before a noun of its language.
  const bool article =
      words.size() > 1 && anyType([&](const NameType* type) {
        if (!type->isArticle(words[0])) return false;
        return words[0].size() > 1 || (type->head_first && type->nouns.count(words[1]) != 0);
      });
  if (article) words.erase(words.begin());
  std::string whole;
  for (const std::string& word : words) whole += (whole.empty() ? "" : " ") + word;
  for (std::size_t i = 0; i < grammars_.size() && key.kind.empty(); ++i) {
    const NameType* type = grammars_[i].compiled().nameType(type_);
    if (type == nullptr) continue;
    const auto kind = type->kinds.find(whole);
    if (kind == type->kinds.end()) continue;
    key.kind = kind->second;
    key.language = i;
  }
  ownerFirst(types, &words);
  dropJoiners(types, &words);
  key.full = key.core = joined(words);
  std::size_t from = 0;
  while (from < words.size()) {
    // "room3" is room 3.
    std::string word = words[from];
    const std::size_t digit = word.find_first_of("0123456789");
    const bool glued = digit != std::string::npos && digit > 0;
    const std::string head = glued ? word.substr(0, digit) : word;
    std::string title;
    bool generic = false, noun = false;
    for (const NameType* type : types) {
      const auto found = type->titles.find(head);
      if (found != type->titles.end() && title.empty()) title = found->second;
      generic = generic || type->generic.count(head) != 0;
      noun = noun || type->nouns.count(head) != 0;
    }
    if (title.empty() && (!generic || glued)) break;
    if (!glued && from + 1 == words.size()) break;
    const std::string rest = (glued ? word.substr(digit) : "") + joined(words, from + 1);
    bool is_code = hasDigit(rest) || rest.size() <= 2;
    // "room two" is room 2.
    for (const Grammar& grammar : grammars_) {
      const auto& numbers = grammar.compiled().number_words;
      is_code = is_code || numbers.count(rest) != 0;
    }
    // "The room of Ana" is hers; but the small meeting room is not the large one.
    if (!(generic && noun) && !is_code) break;
    if (!title.empty()) key.title = title;
    key.core = rest;
    if (glued) {
      words[from] = word.substr(digit);
      continue;
    }
    ++from;
  }
  for (const Grammar& grammar : grammars_) {
    const auto number = grammar.compiled().number_words.find(key.core);
    if (key.title.empty() || number == grammar.compiled().number_words.end()) continue;
    key.core = std::to_string(static_cast<int>(number->second.first));
    break;
  }
  return key;
}

std::optional<PlaceKind> PlaceNames::kindOf(const std::string& name) const {
  const std::vector<std::string> words = wordsOfName(name);
  for (const Grammar& grammar : grammars_) {
    const NameType* type = grammar.compiled().nameType(type_);
    if (type == nullptr) continue;
    // The longest noun at the head: the last in "entrance hall", the first in "sala de estar".
    for (std::size_t k = 0; k < words.size(); ++k) {
      const std::size_t at = type->head_first ? k : words.size() - 1 - k;
      const std::string* kind = nullptr;
      std::string phrase;
      for (std::size_t n = 0; n < 3; ++n) {
        if (type->head_first ? at + n >= words.size() : n > at) break;
        const std::string& word = words[type->head_first ? at + n : at - n];
        if (n > 0) phrase.insert(type->head_first ? phrase.size() : 0, 1, ' ');
        phrase.insert(type->head_first ? phrase.size() : 0, word);
        const auto found = type->nouns.find(phrase);
        if (found != type->nouns.end()) kind = &found->second;
      }
      // "room3"
      const std::size_t digit = words[at].find_first_of("0123456789");
      if (kind == nullptr && digit != std::string::npos && digit > 0) {
        const auto found = type->nouns.find(words[at].substr(0, digit));
        if (found != type->nouns.end()) kind = &found->second;
      }
      if (kind != nullptr) return placeKindFromString(*kind);
    }
  }
  return std::nullopt;
}

std::vector<std::size_t> PlaceNames::find(
    const std::string& name, const std::vector<std::vector<std::string>>& places) const {
  const NameKey wanted = key(name);
  std::vector<std::size_t> exact, perhaps;
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool is = false, may_be = false, cannot_be = false;
    for (const std::string& each : places[i]) {
      const NameKey other = key(each);
      const SameName same = compare(wanted, other);
      is = is || same == SameName::kYes;
      may_be = may_be || same == SameName::kPerhaps;
      // "110" was called "lab 110" since: it is not "room 110".
      cannot_be =
          cannot_be || (same == SameName::kNo && !wanted.core.empty() && wanted.core == other.core);
    }
    if (is) {
      exact.push_back(i);
    } else if (may_be && !cannot_be) {
      perhaps.push_back(i);
    }
  }
  return exact.empty() ? perhaps : exact;
}

}  // namespace hyselam_topo

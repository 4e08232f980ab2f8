#include "object_words.hpp"

#include <algorithm>
#include <sstream>

#include "hyselam_common/utf8.hpp"

namespace hyselam_objects {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool isCapitals(const std::string& word) {
  return std::count_if(word.begin(), word.end(), [](char c) { return c >= 'A' && c <= 'Z'; }) > 1;
}

}  // namespace

std::string lowerCase(const std::string& text) {
  return hyselam::utf8Lower(text);
}

std::vector<std::string> splitWords(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

NounKind ObjectWords::singular(const std::string& word) const {
  constexpr std::size_t kMinLength = 4;  // shorter words have no plural ending
  const auto given = plurals.find(lowerCase(word));
  if (given != plurals.end()) return {given->second, given->second != given->first};
  // "a PC", "two PCs"
  if (word.size() == 3 && endsWith(word, "s") && word[0] >= 'A' && word[0] <= 'Z') {
    return {word.substr(0, 2), true};
  }
  for (const auto& [end, one] : plural_endings) {
    if (word.size() < kMinLength || !endsWith(word, end)) continue;
    return {word.substr(0, word.size() - end.size()) + one, one != end};
  }
  return {word, false};
}

/// The word that takes the plural: the last one, or that before "of".
std::size_t ObjectWords::headAt(const std::vector<std::string>& words) const {
  if (head_first || words.empty()) return 0;
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (of.count(lowerCase(words[i])) != 0) return i - 1;
  }
  return words.size() - 1;
}

std::string ObjectWords::headOf(const std::string& kind) const {
  const std::vector<std::string> words = splitWords(kind);
  return words.empty() ? "" : words[headAt(words)];
}

NounKind ObjectWords::kindOf(const std::string& noun) const {
  const auto kept = synonyms.find(lowerCase(noun));
  if (kept != synonyms.end()) return {kept->second, false};
  NounKind out;
  const std::vector<std::string> words = splitWords(noun);
  const std::size_t head = headAt(words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string word = isCapitals(words[i]) ? words[i] : lowerCase(words[i]);
    if (i == head) {
      const NounKind one = singular(word);
      word = one.kind;
      out.plural = one.plural;
    }
    out.kind += (out.kind.empty() ? "" : " ") + word;
  }
  const auto again = synonyms.find(lowerCase(out.kind));
  if (again != synonyms.end()) out.kind = again->second;
  return out;
}

std::string ObjectWords::pluralOf(const std::string& kind) const {
  std::vector<std::string> words = splitWords(kind);
  if (words.empty()) return kind;
  std::string& head = words[headAt(words)];
  const auto isPluralOfHead = [&](const std::string& word) {
    const NounKind one = singular(word);
    return one.plural && one.kind == head;
  };
  const auto same = plurals.find(lowerCase(head));
  if (same != plurals.end() && same->second == head) return kind;  // "lápis"
  const auto given = std::find_if(plurals.begin(), plurals.end(), [&](const auto& each) {
    return each.second == head && each.first != head;
  });
  if (given != plurals.end()) {
    head = given->first;
  } else if (isCapitals(head)) {
    head += "s";
  } else if (singular(head).kind == head || plurals.count(head) == 0) {
    for (const auto& [end, one] : plural_endings) {
      if (!one.empty() && !endsWith(head, one)) continue;
      const std::string many = head.substr(0, head.size() - one.size()) + end;
      if (!isPluralOfHead(many)) continue;
      head = many;
      break;
    }
  }
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

std::string ObjectWords::formOf(const std::string& kind) const {
  const std::string word = lowerCase(head_first ? headOf(kind) : kind);
  const auto given = forms.find(word);
  if (given != forms.end()) return given->second;
  std::string form;
  std::size_t longest = 0;
  for (const auto& [end, value] : form_endings) {
    const bool fits =
        head_first ? word == end || endsWith(word, end) : word.compare(0, end.size(), end) == 0;
    if (fits && end.size() > longest) {
      longest = end.size();
      form = value;
    }
  }
  const auto any = form_endings.find("");
  return longest == 0 && any != form_endings.end() ? any->second : form;
}

std::string ObjectWords::articleForm(const std::string& said) const {
  if (!head_first || said.empty()) return "";
  std::string word = lowerCase(said);
  if (word.back() == 's') word.pop_back();
  return !word.empty() && word.back() == 'a' ? "f" : "m";
}

bool ObjectWords::isNoun(const std::string& kind) const {
  if (things.count(lowerCase(kind)) != 0 || things.count(lowerCase(headOf(kind))) != 0) return true;
  const std::size_t last = kind.rfind(' ');  // "bed 3"
  const bool numbered = last != std::string::npos && last + 1 < kind.size() &&
                        std::any_of(kind.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                                    kind.end(), [](char c) { return c >= '0' && c <= '9'; });
  return numbered && isNoun(kind.substr(0, last));
}

int ObjectWords::numberOf(const std::string& said) const {
  const std::string word = lowerCase(said);
  const auto found = numbers.find(word);
  if (found != numbers.end()) return found->second;
  const std::size_t dash = word.find('-');
  if (dash == std::string::npos) return 0;
  const auto tens = numbers.find(word.substr(0, dash));
  const auto ones = numbers.find(word.substr(dash + 1));
  const bool both = tens != numbers.end() && ones != numbers.end() && tens->second >= 20 &&
                    tens->second % 10 == 0 && ones->second < 10;
  return both ? tens->second + ones->second : 0;
}

void ObjectWords::index() {
  for (const std::string& noun : nouns) {
    things.insert(lowerCase(noun));
    things.insert(lowerCase(noun) + "s");
    things.insert(lowerCase(pluralOf(noun)));
  }
  for (const auto& [word, kept] : synonyms) things.insert(word);
  for (const auto& [word, kept] : plurals) {
    things.insert(word);
    things.insert(lowerCase(kept));
  }
  for (const std::string& word : mass) things.insert(lowerCase(word));
  for (const auto& [word, reason] : no_things) things.erase(word);
}

}  // namespace hyselam_objects

#include "sentence_writer.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "grammar/compiled_grammar.hpp"
#include "grammar/word_lists.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/building/article.hpp"
#include "name_words.hpp"

namespace hyselam_topo {
namespace {

/// Replaces "{is|are}" by the first or second form.
void chooseForm(std::string* text, std::size_t begin, std::size_t bar, std::size_t end,
                bool plural) {
  const std::string form =
      plural ? text->substr(bar + 1, end - bar - 1) : text->substr(begin + 1, bar - begin - 1);
  text->replace(begin, end + 1 - begin, form);
}

/// Chooses all forms of a template; which value decides is seen before the values are put in.
std::string withForms(std::string text, const std::vector<SaidValue>& values) {
  const auto pluralOf = [&](std::size_t at) {
    const SaidValue* nearest = nullptr;
    std::size_t where = std::string::npos;
    for (const SaidValue& value : values) {
      const std::size_t found = text.find("{" + value.key + "}");
      if (found == std::string::npos) continue;
      const bool better = nearest == nullptr ||
                          (found < at ? where > at || found > where : where > at && found < where);
      if (better) {
        nearest = &value;
        where = found;
      }
    }
    return nearest != nullptr && nearest->plural;
  };
  for (std::size_t bar = text.find('|'); bar != std::string::npos; bar = text.find('|')) {
    const std::size_t begin = text.rfind('{', bar), end = text.find('}', bar);
    if (begin == std::string::npos || end == std::string::npos) break;
    chooseForm(&text, begin, bar, end, pluralOf(begin));
  }
  return text;
}

using Words = std::vector<std::string>;

bool isUpper(char c) {
  return c >= 'A' && c <= 'Z';
}

/// The words of a name up to where it says of what: "room" of "room for the copies".
Words ownWords(const std::string& name, const language::NameType& type) {
  Words words = language::splitWords(name);
  if (type.head_first) return words;
  const auto joiner = std::find_if(words.begin(), words.end(), [&](const std::string& word) {
    return type.joiners.count(word) != 0;
  });
  words.erase(joiner, words.end());
  return words;
}

/// The word of a common noun at the head: the last one in "printer room", the first one in "sala de
/// estar"; "" without one.
std::string headWord(const std::string& name, const language::NameType& type) {
  constexpr std::size_t kLongestNoun = 3;
  const Words words = language::splitWords(hyselam::utf8Fold(name));
  const std::size_t own = ownWords(name, type).size();
  for (std::size_t length = std::min(own, kLongestNoun); length > 0; --length) {
    const std::size_t begin = type.head_first ? 0 : own - length;
    std::string noun = words[begin];
    for (std::size_t k = begin + 1; k < begin + length; ++k) noun += " " + words[k];
    if (type.nouns.count(noun) != 0) return type.head_first ? words[begin] : words[own - 1];
  }
  return "";
}

/// A word of another language for a kind of place, in this one: "corredor" of "corridor"; "": none.
std::string inOwnLanguage(const std::string& name, const language::NameType& type) {
  std::string kind = hyselam::utf8Fold(name);
  std::replace(kind.begin(), kind.end(), ' ', '_');
  std::string first;
  for (const auto& [noun, its_kind] : type.kinds) {
    if (its_kind == kind && (first.empty() || noun < first)) first = noun;
  }
  return first;
}

/// "Paul's": no "girls'", "secretary's".
bool isOwnersName(const std::string& word, const language::NameType& type) {
  const std::size_t apostrophe = word.find('\'');
  if (apostrophe == std::string::npos || apostrophe + 1 == word.size()) return false;
  return type.forbidden.count(hyselam::utf8Fold(word.substr(0, apostrophe))) == 0;
}

/// "The printer room", "the ICT suite", "a sala 5", but "room 5", "Paul's office", "Main Hall".
bool takesArticle(const std::string& name, const language::CompiledGrammar& grammar,
                  const language::NameType& type) {
  if (name.empty() || isUpper(name[0])) {
    const bool acronym = name.size() > 1 && isUpper(name[1]);
    if (!acronym) return false;
  }
  if (type.head_first) return true;
  const Words words = ownWords(name, type);
  if (words.empty()) return false;
  const std::string& last = words.back();
  const bool code = hasDigit(last) || last.size() == 1 || isUpper(last[0]) ||
                    grammar.number_words.count(hyselam::utf8Fold(last)) != 0;
  if (code) return false;
  return std::none_of(words.begin(), words.end(), [&](const std::string& word) {
    const bool proper = isUpper(word[0]) && !(word.size() > 1 && isUpper(word[1]));
    return proper || isOwnersName(word, type);
  });
}

/// The key of the article, in the section `say`; "" without one. `another`: of a second one.
std::string articleKey(const std::string& name, const Grammar& grammar, bool another,
                       bool* plural) {
  const auto* type = grammar.compiled().nameType("place");
  std::string head = type == nullptr ? "" : headWord(name, *type);
  if (type != nullptr && head.empty()) head = headWord(inOwnLanguage(name, *type), *type);
  if (head.empty() || !takesArticle(name, grammar.compiled(), *type)) return "";
  *plural = head.size() > 2 && head.back() == 's' && head[head.size() - 2] != 's';
  const std::string singular = *plural ? head.substr(0, head.size() - 1) : head;
  const bool feminine = type->feminine.count(head) != 0 || type->feminine.count(singular) != 0;
  std::string article = feminine ? "feminine_" : "";
  if (*plural && !another) article += "plural_";
  return article + (another ? "another" : "article");
}

}  // namespace

std::string withArticle(const std::string& name, const Grammar& grammar, bool* plural) {
  bool several = false;
  const std::string key = articleKey(name, grammar, false, &several);
  if (plural != nullptr) *plural = several;
  return key.empty() || !grammar.has(key) ? name : grammar.say(key) + name;
}

std::string withoutArticle(const std::string& name, const Grammar& grammar) {
  const auto* type = grammar.compiled().nameType("place");
  const std::size_t begin = name.find_first_not_of(' ');
  if (type == nullptr || begin == std::string::npos) return name;
  const std::size_t space = name.find(' ', begin);
  const std::size_t rest = name.find_first_not_of(' ', space);
  if (space == std::string::npos || rest == std::string::npos) return name;
  const bool article = type->isArticle(hyselam::utf8Fold(name.substr(begin, space - begin)));
  return article ? name.substr(rest) : name;
}

std::string SentenceWriter::filled(const std::string& key, const std::vector<SaidValue>& values,
                                   bool* begins_with_name) const {
  std::string sentence = withForms(grammar_.say(key), values);
  *begins_with_name = false;
  for (const SaidValue& value : values) {
    const std::size_t at = sentence.find("{" + value.key + "}");
    if (at == std::string::npos) continue;
    if (at == 0) *begins_with_name = value.is_name;
    std::size_t from = at;
    std::string put = value.text;
    const std::size_t word = at >= 2 ? sentence.rfind(' ', at - 2) : std::string::npos;
    const std::size_t begin = word == std::string::npos ? 0 : word + 1;
    const std::size_t space = value.text.find(' ');
    if (at > begin && space != std::string::npos) {
      const std::string both = sentence.substr(begin, at - begin) + value.text.substr(0, space);
      if (grammar_.has(both)) {
        from = begin;
        put = grammar_.say(both) + value.text.substr(space + 1);
      }
    }
    sentence.replace(from, at + value.key.size() + 2 - from, put);
  }
  return sentence;
}

std::string SentenceWriter::sentence(const std::string& key,
                                     const std::vector<SaidValue>& values) const {
  bool begins_with_name = false;
  std::string text = filled(key, values, &begins_with_name);
  if (capitals_ && !begins_with_name && !text.empty() && text[0] >= 'a' && text[0] <= 'z') {
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  }
  return text;
}

std::string SentenceWriter::phrase(const std::string& key,
                                   const std::vector<SaidValue>& values) const {
  bool begins_with_name = false;
  return filled(key, values, &begins_with_name);
}

std::string SentenceWriter::quoted(const std::string& name) const {
  if (grammar_.isPlainName(name)) return name;
  static const std::array<std::pair<const char*, const char*>, 3> kQuotes{
      {{"\"", "\""}, {"\xe2\x80\x9c", "\xe2\x80\x9d"}, {"\xc2\xab", "\xc2\xbb"}}};
  for (const auto& [open, close] : kQuotes) {
    const bool inside =
        name.find(open) != std::string::npos || name.find(close) != std::string::npos;
    if (!inside) return open + name + close;
  }
  throw hyselam::InputError("description", "place '" + name + "'",
                            "its name holds all kinds of quotation marks");
}

SaidValue SentenceWriter::named(const std::string& key, const std::string& name,
                                bool another) const {
  SaidValue value{key, quoted(name), false, true};
  if (value.text != name) return value;
  const std::string article = articleKey(name, grammar_, another, &value.plural);
  if (article.empty()) return value;
  value.text.insert(0, grammar_.say(article));
  value.is_name = false;
  return value;
}

SaidValue SentenceWriter::place(const std::string& key, const DescribedBuilding& building,
                                Id id) const {
  const std::string& name = building.findPlace(id)->name;
  const auto& all = building.places;
  return named(key, name, std::any_of(all.begin(), all.end(), [&](const DescribedPlace& other) {
                 return other.id < id && other.name == name;
               }));
}

SaidValue SentenceWriter::list(const std::string& key, const DescribedBuilding& building,
                               const std::vector<Id>& ids) const {
  SaidValue all{key, "", ids.size() > 1, false};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i > 0) all.text += grammar_.say(i + 1 == ids.size() ? "and" : "comma");
    const SaidValue each = place(key, building, ids[i]);
    if (i == 0) {
      all.is_name = each.is_name;
      all.plural = all.plural || each.plural;
    }
    all.text += each.text;
  }
  return all;
}

}  // namespace hyselam_topo

#include "sentence_writer.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"

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

}  // namespace

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
  const auto* type = grammar_.compiled().nameType("place");
  const bool small = type != nullptr && std::all_of(name.begin(), name.end(), [](char c) {
                       return !(c >= 'A' && c <= 'Z') && !(c >= '0' && c <= '9') && c != '\'';
                     });
  if (!small) return value;
  // The noun at the head: the last words in "printer room", the first ones in "sala de estar".
  const std::string folded = hyselam::utf8Fold(name);
  const std::string first = folded.substr(0, folded.find(' '));
  const std::string last = folded.substr(folded.rfind(' ') + 1);
  const std::string& head = type->head_first ? first : last;
  if (type->nouns.count(folded) == 0 && type->nouns.count(head) == 0) return value;
  value.plural = head.size() > 2 && head.back() == 's' && head[head.size() - 2] != 's';
  const std::string singular = value.plural ? head.substr(0, head.size() - 1) : head;
  const bool feminine = type->feminine.count(head) != 0 || type->feminine.count(singular) != 0;
  std::string article = feminine ? "feminine_" : "";
  if (value.plural && !another) article += "plural_";
  article += another ? "another" : "article";
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

#include "name_type_reader.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/utf8.hpp"
#include "word_lists.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Keys of plain lists of words.
const std::map<std::string, WordSet NameType::*>& wordKeys() {
  static const std::map<std::string, WordSet NameType::*> kKeys{
      {"definite", &NameType::definite},
      {"indefinite", &NameType::indefinite},
      {"joiners", &NameType::joiners},
      {"speaker", &NameType::speaker},
      {"elliptic_suffix", &NameType::elliptic_suffix},
      {"elliptic_prefix", &NameType::elliptic_prefix},
      {"elliptic_after", &NameType::elliptic_after},
      {"elliptic_nouns", &NameType::elliptic_nouns},
      {"elliptic_adjectives", &NameType::elliptic_adjectives},
      {"speaker_alone", &NameType::speaker_alone},
      {"range_words", &NameType::range_words},
      {"generic", &NameType::generic},
      {"heads", &NameType::heads},
      {"quantities", &NameType::quantities},
      {"feminine", &NameType::feminine},
      {"between", &NameType::between},
      {"parts", &NameType::parts},
      {"part_joiners", &NameType::part_joiners}};
  return kKeys;
}

/// Keys of words with a meaning.
const std::map<std::string, WordMeanings NameType::*>& meaningKeys() {
  static const std::map<std::string, WordMeanings NameType::*> kKeys{
      {"forbidden", &NameType::forbidden},
      {"nouns", &NameType::nouns},
      {"titles", &NameType::titles},
      {"kinds", &NameType::kinds},
      {"plurals", &NameType::plurals}};
  return kKeys;
}

/// Without accents, long words mean the same ("tambem"), short ones do not: "dá", "da".
void addStops(const std::vector<std::string>& words, WordSet* set) {
  constexpr std::size_t kLong = 4;
  for (const std::string& word : words) {
    set->insert(hyselam::utf8Lower(word));
    if (hyselam::utf8Fold(word).size() >= kLong) set->insert(hyselam::utf8Fold(word));
  }
}

bool isHeadFirst(const GrammarNode& value) {
  if (value.text() != "first" && value.text() != "last") value.fail("must be first or last");
  return value.text() == "first";
}

std::size_t maxWords(const GrammarNode& value) {
  const double count = value.number();
  if (count < 1.0 || count > 20.0 || count != std::floor(count)) value.fail("must be 1 .. 20");
  return static_cast<std::size_t>(count);
}

/// A new type: empty, or a copy of the one that it is like.
NameType newType(const std::string& name, const GrammarNode& node, const CompiledGrammar& grammar,
                 PatternContext* context) {
  NameType type;
  node.each([&](const std::string& key, const GrammarNode& value) {
    if (key != "like") return;
    const NameType* other = grammar.nameType(value.text());
    if (other == nullptr) value.fail("there is no kind of names '" + value.text() + "'");
    type = *other;
    const auto references = context->references.find(value.text());
    if (references != context->references.end()) context->references[name] = references->second;
  });
  type.name = name;
  return type;
}

}  // namespace

void readNameType(const std::string& name, const GrammarNode& node, CompiledGrammar* grammar,
                  PatternContext* context) {
  auto& types = grammar->name_types;
  auto found = std::find_if(types.begin(), types.end(),
                            [&](const NameType& type) { return type.name == name; });
  if (found == types.end()) {
    types.push_back(newType(name, node, *grammar, context));
    found = types.end() - 1;
  }
  NameType& type = *found;
  node.each([&](const std::string& key, const GrammarNode& value) {
    const auto words = wordKeys().find(key);
    const auto meanings = meaningKeys().find(key);
    if (words != wordKeys().end()) {
      addFolded(value, &(type.*(words->second)));
    } else if (meanings != meaningKeys().end()) {
      addMeanings(value, &(type.*(meanings->second)));
    } else if (key == "stop") {
      addStops(value.texts(), &type.stop);
    } else if (key == "references") {
      value.each([&](const std::string& word, const GrammarNode& texts) {
        context->references[name][word] = texts.texts();
      });
    } else if (key == "head") {
      type.head_first = isHeadFirst(value);
    } else if (key == "only_elliptic") {
      type.only_elliptic = value.truth();
    } else if (key == "silent") {
      type.silent = value.truth();
    } else if (key == "of_speaker") {
      type.of_speaker = value.truth();
    } else if (key == "needs_noun") {
      type.needs_noun = value.truth();
    } else if (key == "indefinite_needs_noun") {
      type.indefinite_needs_noun = value.truth();
    } else if (key == "max_words") {
      type.max_words = maxWords(value);
    } else if (key != "like") {
      value.fail("this key is not known");
    }
  });
}

}  // namespace language
}  // namespace hyselam_topo

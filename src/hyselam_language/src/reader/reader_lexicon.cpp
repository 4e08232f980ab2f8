#include "reader_lexicon.hpp"

#include <array>
#include <set>
#include <sstream>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::array<std::pair<const char*, WordSet ReaderLexicon::*>, 3> kKinds{
    {{"noun", &ReaderLexicon::nouns},
     {"keyword", &ReaderLexicon::keywords},
     {"row", &ReaderLexicon::row_words}}};

bool isOneWord(const std::string& phrase) {
  return !phrase.empty() && phrase.find_first_of(" \t\n") == std::string::npos;
}

}  // namespace

ReaderLexicon ReaderLexicon::of(const CompiledGrammar& grammar) {
  ReaderLexicon lexicon;
  for (const Phrase& phrase : grammar.clause_separators) {
    for (const int word : phrase) lexicon.row_words.insert(grammar.vocabulary.text(word));
  }
  for (const NameType& type : grammar.name_types) {
    for (const auto& [noun, kind] : type.nouns) {
      if (isOneWord(noun)) lexicon.nouns.insert(noun);
    }
    for (const auto& [title, meant] : type.titles) {
      if (isOneWord(title)) lexicon.nouns.insert(title);
    }
    for (const auto* words : {&type.definite, &type.indefinite, &type.between}) {
      lexicon.row_words.insert(words->begin(), words->end());
    }
  }
  for (const std::string& word : grammar.known_words) {
    if (isOneWord(word)) lexicon.keywords.insert(word);
  }
  return lexicon;
}

ReaderLexicon ReaderLexicon::fromText(const std::string& source, const std::string& text) {
  ReaderLexicon lexicon;
  std::istringstream lines(text);
  std::string kind, word;
  while (lines >> kind >> word) {
    bool known = false;
    for (const auto& [name, words] : kKinds) {
      if (kind != name) continue;
      (lexicon.*words).insert(word);
      known = true;
    }
    if (!known)
      throw hyselam::InputError(source, "'" + kind + " " + word + "'", "is no kind of word");
  }
  return lexicon;
}

std::string ReaderLexicon::toText() const {
  std::string text;
  for (const auto& [name, words] : kKinds) {
    const std::set<std::string> sorted((this->*words).begin(), (this->*words).end());
    for (const std::string& word : sorted) text += std::string(name) + " " + word + "\n";
  }
  return text;
}

}  // namespace language
}  // namespace hyselam_topo

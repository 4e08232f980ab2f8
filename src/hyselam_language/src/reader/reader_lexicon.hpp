// What the second reader knows of words besides their looks.
#pragma once

#include <set>
#include <string>

#include "grammar/compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// Folded words.
struct ReaderLexicon {
  std::set<std::string> nouns;      ///< of places and things, and titles before their codes
  std::set<std::string> keywords;   ///< of the grammar
  std::set<std::string> row_words;  ///< that may stand between two names of a row: "and", articles

  /// All that a grammar knows.
  static ReaderLexicon of(const CompiledGrammar& grammar);
  /// Lines "noun WORD", "keyword WORD", "row WORD". Throws hyselam::InputError.
  static ReaderLexicon fromText(const std::string& source, const std::string& text);
  std::string toText() const;
};

}  // namespace language
}  // namespace hyselam_topo

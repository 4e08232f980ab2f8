// What the second reader knows of words besides their looks.
#pragma once

#include <string>

#include "grammar/compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// Folded words.
struct ReaderLexicon {
  WordSet nouns;      ///< of places and things, and titles before their codes
  WordSet keywords;   ///< of the grammar
  WordSet row_words;  ///< that may stand between two names of a row: "and", articles

  /// All that a grammar knows.
  static ReaderLexicon of(const CompiledGrammar& grammar);
  /// Lines "noun WORD", "keyword WORD", "row WORD". Throws hyselam::InputError.
  static ReaderLexicon fromText(const std::string& source, const std::string& text);
  std::string toText() const;
};

}  // namespace language
}  // namespace hyselam_topo

// One sentence read as a row of clauses, each of them a pattern of the grammar, without asides,
// parts or proposals.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {
namespace language {

/// What the tokens before `end` say.
struct Beginning {
  std::size_t end = 0;
  std::vector<Utterance> said;
};

struct ClauseOptions {
  /// Clauses may follow one another without a word or comma between them, as speech recognisers
  /// write them.
  bool run_on = false;
  /// Follows more patterns, whose way tells why the sentence is not understood; without it nothing
  /// is said about that.
  bool explain = false;
  /// Of a sentence that is not understood: the beginnings that a row of clauses covers, the longest
  /// first.
  std::vector<Beginning>* beginnings = nullptr;
  /// Gives only the beginnings that end at one of these tokens, the whole sentence among them.
  const std::vector<std::size_t>* ends = nullptr;
};

/// The cheapest row of clauses that covers the tokens, or one utterance that was not understood.
std::vector<Utterance> readClauses(const CompiledGrammar& grammar, const std::string& text,
                                   const Sentence& sentence, std::vector<Token> tokens,
                                   const std::set<std::string>& expected,
                                   const ClauseOptions& options = {});

/// Whether all of it is.
bool isUnderstood(const std::vector<Utterance>& said);

/// The names in it that are no references, in their order.
std::vector<std::string> namesIn(const std::vector<Utterance>& said);

std::vector<Token> tokensWithin(const std::vector<Token>& tokens, TextRange range);

/// Words of a sentence, some of them left out, as one of its own.
std::string asSentence(const std::string& words);

}  // namespace language
}  // namespace hyselam_topo

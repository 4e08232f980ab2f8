// Numbers and quantities within a sentence: "6", "twenty five", "six and a half feet".
#pragma once

#include <string>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// The words that each token of a sentence may stand for.
using TokenMatches = std::vector<std::vector<Vocabulary::Match>>;

/// The cost of reading the tokens from `at` as a phrase; -1 if they are not.
int phraseCost(const Phrase& phrase, std::size_t at, const TokenMatches& matches);

struct FoundNumber {
  std::size_t end = 0;  ///< the token behind it
  double value = 0.0;
};

/// The numbers that begin at token `at`, shorter ones first.
std::vector<FoundNumber> numbersAt(std::size_t at, const CompiledGrammar& grammar,
                                   const std::vector<Token>& tokens);

struct FoundMeasure {
  std::size_t end = 0;
  int cost = 0;
  double value = 0.0;   ///< as said
  double factor = 0.0;  ///< of the unit; 0: none was said
};

std::vector<FoundMeasure> measuresAt(std::size_t at, const Quantity& quantity,
                                     const CompiledGrammar& grammar,
                                     const std::vector<Token>& tokens, const TokenMatches& matches);

}  // namespace language
}  // namespace hyselam_topo

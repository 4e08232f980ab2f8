// The grammar's examples, of which a refusal shows the nearest.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tokens.hpp"

namespace hyselam_topo {
namespace language {

struct CompiledGrammar;

/// Made once: a refusal compares what was said with some hundred sentences.
class ExampleSentences {
 public:
  ExampleSentences() = default;
  /// Of the intents of a grammar that is read to its end.
  explicit ExampleSentences(const CompiledGrammar& grammar);

  /// The example of the kind (question or not) that shares the most telling words with the tokens;
  /// "" without examples.
  std::string nearest(const std::vector<Token>& said, bool is_question) const;

 private:
  struct Example {
    std::string text;
    std::vector<std::pair<std::string, double>> words;  ///< in their order, each once; its weight
  };
  static std::vector<Example> examplesOf(const CompiledGrammar& grammar, bool is_question);

  std::vector<Example> questions_, others_;
};

}  // namespace language
}  // namespace hyselam_topo

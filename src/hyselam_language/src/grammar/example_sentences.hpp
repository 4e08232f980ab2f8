// The grammar's examples, of which a refusal shows the nearest.
#pragma once

#include <set>
#include <string>
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

  /// The example of the kind (question, command or statement, as the sentence begins) that shares
  /// the most telling words with the tokens, a plain one if none shares any: what is near by other
  /// words has nothing to do with what was said.
  /// "" without examples.
  std::string nearest(const std::vector<Token>& said, bool is_question) const;

 private:
  struct Word {
    std::string text;
    double weight = 0.0;
    bool tells = false;  ///< of places
  };
  struct Example {
    std::string text;
    bool is_command = false;
    std::vector<Word> words;  ///< in their order, each once
  };
  struct Kind {
    std::vector<Example> all;
    std::string plain;
  };
  static Kind examplesOf(const CompiledGrammar& grammar, bool is_question);

  Kind questions_, others_;
  std::set<std::string> orders_;  ///< words with which commands begin
};

}  // namespace language
}  // namespace hyselam_topo

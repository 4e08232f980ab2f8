#include "example_sentences.hpp"

#include <map>
#include <set>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr double kTellsNothing = 0.05;  ///< the weight of a word that tells nothing of places

std::set<std::string> wordsOf(const std::vector<Token>& tokens) {
  std::set<std::string> words;
  for (const Token& token : tokens) {
    if (token.kind == TokenKind::kWord) words.insert(token.folded);
  }
  return words;
}

}  // namespace

ExampleSentences::ExampleSentences(const CompiledGrammar& grammar)
    : questions_(examplesOf(grammar, true)), others_(examplesOf(grammar, false)) {}

std::vector<ExampleSentences::Example> ExampleSentences::examplesOf(const CompiledGrammar& grammar,
                                                                    bool is_question) {
  std::vector<std::pair<std::string, std::set<std::string>>> examples;
  std::map<std::string, int> frequency;
  for (const IntentInfo& intent : grammar.intents) {
    const bool asks = intent.kind == UtteranceKind::kQuestion;
    // Those that cost less than nothing are for what the robot itself says.
    const bool for_people = intent.refuse.empty() && intent.cost >= 0;
    if (!for_people || intent.kind == UtteranceKind::kAnswer || asks != is_question) continue;
    for (const std::string& text : intent.examples) {
      examples.emplace_back(text, wordsOf(tokenize(text, {0, text.size()}, grammar.tokenRules())));
      for (const std::string& word : examples.back().second) ++frequency[word];
    }
  }
  // A word counts the more the fewer examples have it.
  std::vector<Example> weighted;
  for (auto& [text, words] : examples) {
    Example example{text, {}};
    for (const std::string& word : words) {
      const double tells = grammar.telling_words.count(word) != 0 ? 1.0 : kTellsNothing;
      example.words.emplace_back(word, tells / frequency[word]);
    }
    weighted.push_back(std::move(example));
  }
  return weighted;
}

std::string ExampleSentences::nearest(const std::vector<Token>& said, bool is_question) const {
  const std::set<std::string> words = wordsOf(said);
  double best = -1.0;
  std::string nearest;
  for (const Example& example : is_question ? questions_ : others_) {
    double shared = 0.0;
    for (const auto& [word, weight] : example.words) {
      if (words.count(word) != 0) shared += weight;
    }
    if (shared > best) {
      best = shared;
      nearest = example.text;
    }
  }
  return nearest;
}

}  // namespace language
}  // namespace hyselam_topo

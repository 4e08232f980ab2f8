#include "example_sentences.hpp"

#include <map>
#include <set>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Intents whose first examples are plain.
constexpr char kPlainStatement[] = "next_to", kPlainQuestion[] = "where_is";
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
    : questions_(examplesOf(grammar, true)), others_(examplesOf(grammar, false)) {
  std::set<std::string> others;
  for (const Example& example : others_.all) {
    const auto tokens = tokenize(example.text, {0, example.text.size()}, grammar.tokenRules());
    if (!tokens.empty()) (example.is_command ? orders_ : others).insert(tokens.front().folded);
  }
  for (const std::string& word : others) orders_.erase(word);
}

ExampleSentences::Kind ExampleSentences::examplesOf(const CompiledGrammar& grammar,
                                                    bool is_question) {
  Kind kind;
  const std::string plain = is_question ? kPlainQuestion : kPlainStatement;
  struct Text {
    std::string text;
    std::set<std::string> words;
    bool is_command = false;
  };
  std::vector<Text> examples;
  std::map<std::string, int> frequency;
  for (const IntentInfo& intent : grammar.intents) {
    const bool asks = intent.kind == UtteranceKind::kQuestion;
    // Those that cost less than nothing are for what the robot itself says.
    const bool for_people = intent.refuse.empty() && intent.cost >= 0;
    if (!for_people || intent.kind == UtteranceKind::kAnswer || asks != is_question) continue;
    if (intent.name == plain && !intent.examples.empty()) kind.plain = intent.examples.front();
    for (const std::string& text : intent.examples) {
      examples.push_back({text, wordsOf(tokenize(text, {0, text.size()}, grammar.tokenRules())),
                          intent.kind == UtteranceKind::kCommand});
      for (const std::string& word : examples.back().words) ++frequency[word];
    }
  }
  // A word counts the more the fewer examples have it.
  for (const auto& [text, words, is_command] : examples) {
    Example example{text, is_command, {}};
    for (const std::string& word : words) {
      const bool tells = grammar.telling_words.count(word) != 0;
      example.words.push_back({word, (tells ? 1.0 : kTellsNothing) / frequency[word], tells});
    }
    kind.all.push_back(std::move(example));
  }
  if (kind.plain.empty() && !kind.all.empty()) kind.plain = kind.all.front().text;
  return kind;
}

std::string ExampleSentences::nearest(const std::vector<Token>& said, bool is_question) const {
  const std::set<std::string> words = wordsOf(said);
  const Kind& kind = is_question ? questions_ : others_;
  double best = -1.0;
  std::string nearest = kind.plain;
  const bool orders = !said.empty() && orders_.count(said.front().folded) != 0;
  for (const Example& example : kind.all) {
    if (!is_question && example.is_command != orders) continue;
    double shared = 0.0;
    bool any_tells = false;
    for (const Word& word : example.words) {
      if (words.count(word.text) == 0) continue;
      shared += word.weight;
      any_tells = any_tells || word.tells;
    }
    if (any_tells && shared > best) {
      best = shared;
      nearest = example.text;
    }
  }
  return nearest;
}

}  // namespace language
}  // namespace hyselam_topo

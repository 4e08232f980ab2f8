#include "word_lists.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace language {

Words splitWords(const std::string& text) {
  std::vector<std::string_view> fields;
  hyselam::splitFields(text, &fields);
  return {fields.begin(), fields.end()};
}

namespace {

constexpr std::size_t kMostExpanded = 10000;  // phrases of one text; brackets multiply

}  // namespace

std::vector<std::string> expanded(const std::string& text) {
  const std::size_t open = text.find_first_of("([");
  if (open == std::string::npos) return {text};
  std::vector<std::string> inside;
  if (text[open] == '[') inside.emplace_back();
  std::size_t begin = open + 1, at = begin;
  for (int depth = 1; depth > 0; ++at) {
    if (at == text.size()) return {};
    const char c = text[at];
    if (c == '(' || c == '[') ++depth;
    if (c == ')' || c == ']') --depth;
    if (depth == 0 || (depth == 1 && c == '|')) {
      std::vector<std::string> choice = expanded(text.substr(begin, at - begin));
      if (choice.empty() || inside.size() + choice.size() > kMostExpanded) return {};
      std::move(choice.begin(), choice.end(), std::back_inserter(inside));
      begin = at + 1;
    }
  }
  const std::vector<std::string> rests = expanded(text.substr(at));
  if (inside.size() * rests.size() > kMostExpanded) return {};
  std::vector<std::string> all;
  for (const std::string& rest : rests) {
    for (const std::string& each : inside) all.push_back(text.substr(0, open) + each + rest);
  }
  return all;
}

std::vector<std::string> expanded(const GrammarNode& node, const std::string& text) {
  std::vector<std::string> all = expanded(text);
  if (all.empty()) {
    node.fail("'" + text + "' has a bracket that is not closed, or stands for more than " +
              std::to_string(kMostExpanded) + " phrases");
  }
  return all;
}

Phrase phraseOf(const std::string& text, Vocabulary* vocabulary) {
  Phrase numbers;
  for (const std::string& word : splitWords(text)) numbers.push_back(vocabulary->add(word));
  return numbers;
}

void addPhrases(const GrammarNode& node, Vocabulary* vocabulary, std::vector<Phrase>* phrases) {
  for (const std::string& text : node.texts()) {
    for (const std::string& each : expanded(node, text)) {
      phrases->push_back(phraseOf(each, vocabulary));
      if (phrases->back().empty()) node.fail("there is an empty entry");
    }
  }
}

void addFolded(const GrammarNode& node, WordSet* words) {
  for (const std::string& word : node.texts()) words->insert(hyselam::utf8Fold(word));
}

void addMeanings(const GrammarNode& node, WordMeanings* meanings) {
  node.each([&](const std::string& meaning, const GrammarNode& words) {
    for (const std::string& word : words.texts()) (*meanings)[hyselam::utf8Fold(word)] = meaning;
  });
}

}  // namespace language
}  // namespace hyselam_topo

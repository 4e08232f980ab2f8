#include "word_lists.hpp"

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

Phrase phraseOf(const std::string& text, Vocabulary* vocabulary) {
  Phrase numbers;
  for (const std::string& word : splitWords(text)) numbers.push_back(vocabulary->add(word));
  return numbers;
}

void addPhrases(const GrammarNode& node, Vocabulary* vocabulary, std::vector<Phrase>* phrases) {
  for (const std::string& text : node.texts()) {
    phrases->push_back(phraseOf(text, vocabulary));
    if (phrases->back().empty()) node.fail("there is an empty entry");
  }
}

void addFolded(const GrammarNode& node, std::set<std::string>* words) {
  for (const std::string& word : node.texts()) words->insert(hyselam::utf8Fold(word));
}

void addMeanings(const GrammarNode& node, std::map<std::string, std::string>* meanings) {
  node.each([&](const std::string& meaning, const GrammarNode& words) {
    for (const std::string& word : words.texts()) (*meanings)[hyselam::utf8Fold(word)] = meaning;
  });
}

}  // namespace language
}  // namespace hyselam_topo

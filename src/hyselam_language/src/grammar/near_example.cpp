#include "hyselam_language/grammar/near_example.hpp"

#include <algorithm>
#include <set>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace {

constexpr std::size_t kMoreThanIn = 4;  // letters: "in", "on", "em" place anything anywhere

}  // namespace

bool isNearExample(const std::string& said, const std::string& example, const Grammar& grammar) {
  const language::CompiledGrammar& compiled = grammar.compiled();
  const bool has_placing = !compiled.placing_words.empty();
  const auto& placing = has_placing ? compiled.placing_words : compiled.telling_words;
  const auto placingIn = [&](const std::string& text) {
    std::set<std::string> words;
    for (const auto& token : language::tokenize(text, {0, text.size()}, compiled.tokenRules())) {
      if (placing.count(token.folded) != 0) words.insert(token.folded);
    }
    return words;
  };
  const std::set<std::string> of_example = placingIn(example), of_said = placingIn(said);
  return std::includes(of_said.begin(), of_said.end(), of_example.begin(), of_example.end()) &&
         std::any_of(of_example.begin(), of_example.end(),
                     [&](const auto& word) { return has_placing || word.size() >= kMoreThanIn; });
}

}  // namespace hyselam_topo

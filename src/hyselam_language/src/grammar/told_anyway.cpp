#include "told_anyway.hpp"

#include <algorithm>

namespace hyselam_topo {
namespace language {
namespace {

void dropCommas(std::vector<Token>* tokens) {
  while (!tokens->empty() && isComma(tokens->back())) tokens->pop_back();
  while (!tokens->empty() && isComma(tokens->front())) tokens->erase(tokens->begin());
}

}  // namespace

bool dropToldAnyway(const CompiledGrammar& grammar, std::vector<Token>* tokens) {
  bool dropped = false;
  for (const Words& phrase : grammar.told_after) {
    const std::size_t size = phrase.size();
    if (tokens->size() <= size || !standsAt(phrase, *tokens, tokens->size() - size)) continue;
    tokens->resize(tokens->size() - size);
    dropped = true;
    break;
  }
  for (const Words& phrase : grammar.told_before) {
    if (tokens->size() <= phrase.size() || !standsAt(phrase, *tokens, 0)) continue;
    tokens->erase(tokens->begin(), tokens->begin() + static_cast<std::ptrdiff_t>(phrase.size()));
    dropped = true;
    break;
  }
  dropCommas(tokens);
  return dropped && !tokens->empty();
}

}  // namespace language
}  // namespace hyselam_topo

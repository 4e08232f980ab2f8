#include "measures.hpp"

#include <cmath>

namespace hyselam_topo {
namespace language {
namespace {

/// A number word: its value and whether units may follow ("twenty").
const std::pair<double, bool>* numberWord(const CompiledGrammar& grammar, const Token& token) {
  if (token.kind != TokenKind::kWord) return nullptr;
  const auto found = grammar.number_words.find(token.folded);
  return found == grammar.number_words.end() ? nullptr : &found->second;
}

}  // namespace

int phraseCost(const Phrase& phrase, std::size_t at, const TokenMatches& matches) {
  if (at + phrase.size() > matches.size()) return -1;
  int cost = 0;
  for (std::size_t i = 0; i < phrase.size(); ++i) {
    int best = -1;
    for (const Vocabulary::Match& match : matches[at + i]) {
      if (match.word == phrase[i] && (best < 0 || match.cost < best)) best = match.cost;
    }
    if (best < 0) return -1;
    cost += best;
  }
  return cost;
}

std::vector<FoundNumber> numbersAt(std::size_t at, const CompiledGrammar& grammar,
                                   const std::vector<Token>& tokens) {
  std::vector<FoundNumber> found;
  if (at >= tokens.size()) return found;
  const Token& token = tokens[at];
  if (token.kind == TokenKind::kNumber) {
    found.push_back({at + 1, token.number});
    return found;
  }
  // "twenty-five" is one token.
  const std::size_t dash = token.folded.find('-');
  if (token.kind == TokenKind::kWord && dash != std::string::npos) {
    const auto tens = grammar.number_words.find(token.folded.substr(0, dash));
    const auto unit = grammar.number_words.find(token.folded.substr(dash + 1));
    const bool number = tens != grammar.number_words.end() && unit != grammar.number_words.end() &&
                        tens->second.second && unit->second.first < 10.0;
    if (number) found.push_back({at + 1, tens->second.first + unit->second.first});
    return found;
  }
  const auto* word = numberWord(grammar, token);
  if (word == nullptr) return found;
  found.push_back({at + 1, word->first});
  if (!word->second) return found;
  std::size_t next = at + 1;
  if (next < tokens.size() && grammar.number_joiners.count(tokens[next].folded) != 0) ++next;
  const auto* unit = next < tokens.size() ? numberWord(grammar, tokens[next]) : nullptr;
  if (unit != nullptr && unit->first > 0.0 && unit->first < 10.0) {
    found.push_back({next + 1, word->first + unit->first});
  }
  return found;
}

std::vector<FoundMeasure> measuresAt(std::size_t at, const Quantity& quantity,
                                     const CompiledGrammar& grammar,
                                     const std::vector<Token>& tokens,
                                     const TokenMatches& matches) {
  std::vector<FoundMeasure> found;
  // "and a half" may stand before and behind the unit.
  const auto add = [&](FoundMeasure measure) {
    found.push_back(measure);
    if (measure.value != std::floor(measure.value)) return;
    for (const Phrase& half : grammar.halves) {
      const int cost = phraseCost(half, measure.end, matches);
      if (cost < 0) continue;
      found.push_back(
          {measure.end + half.size(), measure.cost + cost, measure.value + 0.5, measure.factor});
    }
  };
  for (const FoundNumber& number : numbersAt(at, grammar, tokens)) {
    add({number.end, 0, number.value, 0.0});
  }
  const std::size_t plain = found.size();
  for (std::size_t i = 0; i < plain; ++i) {
    const FoundMeasure number = found[i];
    for (const Unit& unit : quantity.units) {
      for (const Phrase& phrase : unit.phrases) {
        const int cost = phraseCost(phrase, number.end, matches);
        if (cost < 0) continue;
        add({number.end + phrase.size(), number.cost + cost, number.value, unit.factor});
      }
    }
  }
  if (quantity.default_factor <= 0.0) {
    found.erase(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(plain));
  }
  return found;
}

}  // namespace language
}  // namespace hyselam_topo

#include "hyselam_language/grammar/words_left_out.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "compiled_grammar.hpp"
#include "tokens.hpp"

namespace hyselam_topo {
namespace {

using language::Token;
using language::TokenKind;

std::vector<Token> tokensOf(const std::string& text, const language::CompiledGrammar& grammar) {
  return language::tokenize(text, {0, text.size()}, grammar.tokenRules());
}

bool isSign(const Token& token) {
  return token.kind == TokenKind::kComma || token.kind == TokenKind::kMark;
}

/// "Hoist's" is "hoist".
bool isSame(const Token& a, const Token& b) {
  const auto stem = [](const std::string& word) {
    const bool is_cut = word.size() > 2 && word.compare(word.size() - 2, 2, "'s") == 0;
    return std::string_view(word).substr(0, word.size() - (is_cut ? 2 : 0));
  };
  return stem(a.folded) == stem(b.folded);
}

/// Which tokens are in the longest common sequence of both.
std::vector<bool> keptOf(const std::vector<Token>& said, const std::vector<Token>& proposed) {
  const std::size_t columns = proposed.size() + 1;
  std::vector<std::size_t> length((said.size() + 1) * columns, 0);  // of the rest behind both
  for (std::size_t i = said.size(); i-- > 0;) {
    for (std::size_t k = proposed.size(); k-- > 0;) {
      length[i * columns + k] =
          isSame(said[i], proposed[k])
              ? 1 + length[(i + 1) * columns + k + 1]
              : std::max(length[(i + 1) * columns + k], length[i * columns + k + 1]);
    }
  }
  std::vector<bool> kept(said.size(), false);
  for (std::size_t i = 0, k = 0; i < said.size() && k < proposed.size();) {
    if (isSame(said[i], proposed[k])) {
      kept[i++] = true;
      ++k;
    } else if (length[(i + 1) * columns + k] >= length[i * columns + k + 1]) {
      ++i;
    } else {
      ++k;
    }
  }
  return kept;
}

/// All but what is never within a name ("so", "you", "is") and places nothing.
bool tells(const Token& token, const language::CompiledGrammar& grammar) {
  if (isSign(token)) return false;
  if (token.kind != TokenKind::kWord || grammar.isNounOrTitle(token.folded) ||
      grammar.placing_words.count(token.folded) != 0) {
    return true;
  }
  const language::NameType* places = grammar.nameType("place");
  return places == nullptr ||
         (places->stop.count(token.folded) == 0 && places->joiners.count(token.folded) == 0 &&
          !places->isArticle(token.folded));
}

}  // namespace

std::vector<std::string> wordsLeftOut(const std::string& said, const std::string& proposed,
                                      const Grammar& grammar) {
  // Longer texts are never proposed; the table is quadratic.
  constexpr std::size_t kMostWords = 200;
  const language::CompiledGrammar& compiled = grammar.compiled();
  const std::vector<Token> tokens = tokensOf(said, compiled);
  const std::vector<Token> others = tokensOf(proposed, compiled);
  if (tokens.size() > kMostWords || others.size() > kMostWords) return {};
  const std::vector<bool> kept = keptOf(tokens, others);
  std::vector<std::string> runs;
  for (std::size_t at = 0; at < tokens.size();) {
    if (kept[at] || isSign(tokens[at])) {
      ++at;
      continue;
    }
    std::size_t end = at, last = at;  // the last word of the run
    bool is_told = false;
    for (; end < tokens.size() && !kept[end]; ++end) {
      is_told = is_told || tells(tokens[end], compiled);
      if (!isSign(tokens[end])) last = end;
    }
    if (is_told) {
      runs.push_back(
          said.substr(tokens[at].range.begin, tokens[last].range.end - tokens[at].range.begin));
    }
    at = end;
  }
  return runs;
}

std::string quotedInARow(const std::vector<std::string>& runs) {
  std::string row;
  std::set<std::string> told;
  for (const std::string& run : runs) {
    if (told.insert(run).second) row += (row.empty() ? "" : "', '") + run;
  }
  return row;
}

}  // namespace hyselam_topo

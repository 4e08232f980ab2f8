#include "sentence_parts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "asides.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kMostParts = 8;  // more are a story
constexpr int kReadCost = 1;
constexpr int kAsideCost = 4;
constexpr int kLostCost = 20;  ///< a part that tells something and is not understood

/// Whether one of the phrases stands at a token, word by word.
bool standsAt(const std::vector<Phrase>& phrases, const std::vector<Token>& tokens, std::size_t at,
              const Vocabulary& vocabulary) {
  return std::any_of(phrases.begin(), phrases.end(), [&](const Phrase& phrase) {
    if (at + phrase.size() > tokens.size()) return false;
    for (std::size_t i = 0; i < phrase.size(); ++i) {
      if (tokens[at + i].lower != vocabulary.text(phrase[i])) return false;
    }
    return true;
  });
}

/// Tokens [begin, end) between borders: commas, and words such as "and".
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<Part> partsOf(const std::vector<Token>& tokens, const CompiledGrammar& grammar) {
  std::vector<Part> parts;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    const bool border = at == 0 || isComma(tokens[at - 1]) ||
                        standsAt(grammar.clause_separators, tokens, at, grammar.vocabulary);
    if (isComma(tokens[at])) continue;
    const bool behind_separator =
        !parts.empty() && parts.back().end == at && parts.back().end == parts.back().begin + 1 &&
        standsAt(grammar.clause_separators, tokens, parts.back().begin, grammar.vocabulary);
    if (border && !behind_separator) parts.push_back({at, at});
    parts.back().end = at + 1;
  }
  return parts;
}

/// Whether the part may change what the others say: doubt, a condition, a choice, a correction.
bool mayChangeOthers(const Part& part, const std::vector<Token>& tokens,
                     const CompiledGrammar& grammar) {
  for (std::size_t at = part.begin; at < part.end; ++at) {
    at = fillerEnd(tokens, at, grammar);
    if (at >= part.end) break;
    if (isReflexive(tokens, at, grammar)) continue;
    const auto code = grammar.refusing_words.find(tokens[at].folded);
    const bool doubts =
        code != grammar.refusing_words.end() &&
        (code->second == "uncertain" || code->second == "choice" || code->second == "condition");
    if (doubts || standsAt(grammar.corrections, tokens, at, grammar.vocabulary)) return true;
  }
  return false;
}

/// "[The lab is next to the bar,] not next to the library", "not the kitchen": it denies nothing
/// that is told beside it.
bool isContrast(const Part& part, const std::vector<Token>& tokens,
                const CompiledGrammar& grammar) {
  std::size_t at = part.begin;
  if (standsAt(grammar.clause_separators, tokens, at, grammar.vocabulary)) ++at;
  if (at + 1 >= part.end) return false;
  const auto code = grammar.refusing_words.find(tokens[at].folded);
  if (code == grammar.refusing_words.end() || code->second != "denial") return false;
  const Token& next = tokens[at + 1];
  const NameType* places = grammar.nameType("place");
  return grammar.placing_words.count(next.folded) != 0 || next.starts_upper ||
         (places != nullptr && places->isArticle(next.folded));
}

class Parts {
 public:
  Parts(const std::vector<Token>& tokens, const std::string& text, const CompiledGrammar& grammar,
        const ReadTokens& read)
      : tokens_(tokens), text_(text), grammar_(grammar), read_(read) {}

  std::vector<Utterance> run() {
    parts_ = partsOf(tokens_, grammar_);
    if (parts_.size() < 2 || parts_.size() > kMostParts) return {};
    best_.assign(parts_.size() + 1, {});
    best_[0].cost = 0;
    for (std::size_t end = 1; end <= parts_.size(); ++end) {
      for (std::size_t begin = 0; begin < end; ++begin) extend(begin, end);
    }
    return assemble();
  }

 private:
  struct Best {
    int cost = std::numeric_limits<int>::max() / 2;
    std::size_t from = 0;
    bool understood = false;
    std::vector<Utterance> said;
  };

  std::vector<Token> tokensOf(std::size_t begin, std::size_t end) const {
    return {tokens_.begin() + static_cast<std::ptrdiff_t>(parts_[begin].begin),
            tokens_.begin() + static_cast<std::ptrdiff_t>(parts_[end - 1].end)};
  }

  void extend(std::size_t begin, std::size_t end) {
    const bool single = end == begin + 1;
    std::vector<Utterance> said = read_(tokensOf(begin, end));
    const bool understood =
        std::all_of(said.begin(), said.end(), [](const Utterance& u) { return u.understood(); });
    if (!understood && !single) return;
    const int cost = best_[begin].cost + (understood     ? kReadCost
                                          : tells(begin) ? kLostCost
                                                         : kAsideCost);
    if (cost < best_[end].cost) best_[end] = {cost, begin, understood, std::move(said)};
  }

  bool tells(std::size_t part) const {
    return asidesOf(tokensOf(part, part + 1), grammar_, true).empty();
  }

  std::vector<Utterance> assemble() const {
    std::vector<std::size_t> ends;
    for (std::size_t end = parts_.size(); end > 0; end = best_[end].from) ends.push_back(end);
    std::reverse(ends.begin(), ends.end());
    std::vector<Utterance> all;
    std::vector<std::string> left_out;
    bool understood = false, lost_before = false;
    for (const std::size_t end : ends) {
      const Best& part = best_[end];
      if (part.understood) {
        // "Between A, which …, and B is C": what stands behind a lost part may be a piece of it.
        // "Yes, that's the one, the lab": a "yes" at the beginning is one whatever follows.
        const bool is_piece =
            std::any_of(part.said.begin(), part.said.end(), [&](const Utterance& u) {
              const bool yes = end == ends.front() && u.intent == "yes";
              return (u.kind == UtteranceKind::kAnswer && !yes) ||
                     (lost_before && u.intent == "alias");
            });
        if (is_piece) return {};
        all.insert(all.end(), part.said.begin(), part.said.end());
        // A greeting is no part that anything is clear of.
        understood =
            understood || std::any_of(part.said.begin(), part.said.end(), [](const Utterance& u) {
              return u.kind == UtteranceKind::kStatement || !u.slots.empty() ||
                     u.intent == "follow_me";
            });
        continue;
      }
      const bool contrast = understood && isContrast(parts_[end - 1], tokens_, grammar_);
      if (!contrast && mayChangeOthers(parts_[end - 1], tokens_, grammar_)) return {};
      if (!contrast && tells(end - 1)) {
        lost_before = true;
        all.push_back(part.said.front());
      } else {
        const TextRange from = tokens_[parts_[end - 1].begin].range;
        const TextRange to = tokens_[parts_[end - 1].end - 1].range;
        left_out.push_back(text_.substr(from.begin, to.end - from.begin));
      }
    }
    if (!understood) return {};
    const auto first =
        std::find_if(all.begin(), all.end(), [](const Utterance& u) { return u.understood(); });
    first->left_out.insert(first->left_out.end(), left_out.begin(), left_out.end());
    return all;
  }

  const std::vector<Token>& tokens_;
  const std::string& text_;
  const CompiledGrammar& grammar_;
  const ReadTokens& read_;
  std::vector<Part> parts_;
  std::vector<Best> best_;  ///< of the first parts, by their number
};

}  // namespace

std::vector<Utterance> readParts(const std::vector<Token>& tokens, const std::string& text,
                                 const CompiledGrammar& grammar, const ReadTokens& read) {
  return Parts(tokens, text, grammar, read).run();
}

}  // namespace language
}  // namespace hyselam_topo

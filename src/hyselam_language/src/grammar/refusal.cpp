#include "refusal.hpp"

#include <algorithm>
#include <optional>

#include "asides.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr char kPart[] = "part_of_place";

/// A word that no sentence may have, as of a denial.
std::optional<Utterance> refusingWord(const SentenceWords& words) {
  const auto& known = words.grammar.refusing_words;
  for (std::size_t at = 0; at < words.tokens.size(); ++at) {
    // "If you please" is no condition.
    at = fillerEnd(words.tokens, at, words.grammar);
    if (at == words.tokens.size()) break;
    if (isReflexive(words.tokens, at, words.grammar)) continue;
    const Token& token = words.tokens[at];
    const auto code = known.find(token.folded);
    if (token.kind == TokenKind::kWord && code != known.end()) {
      return refusal(words, code->second, token.range, token.text);
    }
  }
  return std::nullopt;
}

std::optional<Utterance> negativeNumber(const SentenceWords& words) {
  const auto& tokens = words.tokens;
  for (std::size_t k = 0; k + 1 < tokens.size(); ++k) {
    const Token &sign = tokens[k], &number = tokens[k + 1];
    const bool apart = k == 0 || tokens[k - 1].range.end < sign.range.begin;
    if (apart && sign.text == "-" && number.kind == TokenKind::kNumber &&
        sign.range.end == number.range.begin) {
      return refusal(words, "negative", {sign.range.begin, number.range.end});
    }
  }
  return std::nullopt;
}

/// What is no name although it seemed to be. The reason that lies furthest on: there the sentence
/// could not be followed any more.
std::optional<Utterance> wrongName(const SentenceWords& words, std::size_t furthest) {
  const NameFailure* failure = nullptr;
  for (const NameFailure& each : words.names.failures()) {
    if (each.at + 2 < furthest && each.code != kPart) continue;
    if (failure == nullptr || each.at >= failure->at) failure = &each;
  }
  if (failure == nullptr) return std::nullopt;
  const Token& token = words.tokens[failure->at];
  if (failure->code == kPart) {
    const std::size_t end = words.tokens[failure->end - 1].range.end;
    return refusal(words, failure->code, {token.range.begin, end});
  }
  return refusal(words, failure->code, token.range, token.text);
}

}  // namespace

Utterance refusal(const SentenceWords& words, const std::string& code, TextRange culprit,
                  const std::string& word) {
  Utterance utterance;
  utterance.range = words.sentence.range;
  utterance.text = words.textOf(utterance.range);
  utterance.reason_code = code;
  utterance.reason = words.grammar.reason(code, word);
  utterance.culprit = culprit;
  return utterance;
}

Utterance refusal(const SentenceWords& words, const std::string& code, TextRange culprit) {
  return refusal(words, code, culprit, words.textOf(culprit));
}

Utterance whyNot(const SentenceWords& words, std::size_t furthest) {
  const auto& tokens = words.tokens;
  if (tokens.empty()) return refusal(words, "no_pattern", words.sentence.range);
  if (words.sentence.is_question) return refusal(words, "question", words.sentence.range);
  if (const auto found = refusingWord(words)) return *found;
  if (const auto found = negativeNumber(words)) return *found;
  if (const auto found = wrongName(words, furthest)) return *found;
  const std::size_t at = std::min(furthest, tokens.size() - 1);
  return refusal(words, "no_pattern", {tokens[at].range.begin, tokens.back().range.end});
}

}  // namespace language
}  // namespace hyselam_topo

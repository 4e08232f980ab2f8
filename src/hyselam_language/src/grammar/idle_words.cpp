#include "idle_words.hpp"

#include <algorithm>

#include "capture.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kLongest = 8;  // words of a phrase that is passed on the way

/// A room, a thing, or a part of a place; not the corridor along which things are told.
bool isThing(const Token& token, const CompiledGrammar& grammar) {
  if (token.kind != TokenKind::kWord) return false;
  const auto& types = grammar.name_types;
  const bool corridor = std::any_of(types.begin(), types.end(), [&](const NameType& type) {
    const auto found = type.nouns.find(token.folded);
    return found != type.nouns.end() && found->second == "corridor";
  });
  if (corridor) return false;
  return grammar.isNounOrTitle(token.folded) ||
         std::any_of(types.begin(), types.end(),
                     [&](const NameType& type) { return type.parts.count(token.folded) != 0; });
}

/// More than one: "one" and "a" may be the same word.
bool isNumber(const Token& token, const CompiledGrammar& grammar) {
  if (token.kind == TokenKind::kNumber) return true;
  const auto found = grammar.number_words.find(token.folded);
  return found != grammar.number_words.end() && found->second.first > 1.0;
}

bool isDenial(const Token& token, const CompiledGrammar& grammar) {
  const auto found = grammar.refusing_words.find(token.folded);
  return found != grammar.refusing_words.end() && found->second == "denial";
}

/// Whether a token is one of several words of correction with which a clause begins, with or
/// without commas: "no, wait"; "no" alone denies.
bool isOfCorrection(std::size_t token, const Clause& clause, const SentenceWords& words) {
  return std::any_of(words.grammar.corrections.begin(), words.grammar.corrections.end(),
                     [&](const Phrase& phrase) {
                       std::size_t at = clause.begin;
                       for (const auto& word : phrase) {
                         while (at < clause.end && words.isComma(at)) ++at;
                         if (at == clause.end) return false;
                         if (words.tokens[at++].lower != words.grammar.vocabulary.text(word))
                           return false;
                       }
                       return phrase.size() > 1 && token < at;
                     });
}

/// Whether words that place something stand there: "after the fire door", not "the second door".
bool places(const SentenceWords& words, std::size_t begin, std::size_t end) {
  for (std::size_t at = begin; at < end; ++at) {
    const std::string& word = words.tokens[at].folded;
    if (words.grammar.telling_words.count(word) == 0 || isThing(words.tokens[at], words.grammar)) {
      continue;
    }
    return true;
  }
  return false;
}

/// The tokens that no slot has taken.
std::vector<bool> freeTokens(const Clause& clause, std::size_t size,
                             const std::vector<PatternRun::Step>& path) {
  std::vector<bool> is_free(size, false);
  std::fill(is_free.begin() + static_cast<std::ptrdiff_t>(clause.begin),
            is_free.begin() + static_cast<std::ptrdiff_t>(clause.end), true);
  std::vector<std::pair<int, std::size_t>> begins;  // of slots of word classes
  const auto take = [&](std::size_t from, std::size_t to) {
    for (std::size_t at = from; at < to; ++at) is_free[at] = false;
  };
  for (const PatternRun::Step& step : path) {
    if (!step.edge) continue;
    switch (step.edge->kind) {
      case EdgeKind::kName:
      case EdgeKind::kCount:
      case EdgeKind::kNumber:
      case EdgeKind::kQuantity:
        take(step.from, step.to);
        break;
      case EdgeKind::kBegin:
        begins.emplace_back(step.edge->a, step.from);
        break;
      case EdgeKind::kValue: {
        const auto found = std::find_if(begins.rbegin(), begins.rend(), [&](const auto& each) {
          return each.first == step.edge->a;
        });
        if (found != begins.rend()) take(found->second, step.to);
        break;
      }
      default:
        break;
    }
  }
  return is_free;
}

const std::string& meaningOf(const IntentInfo& intent) {
  return intent.as.empty() ? intent.name : intent.as;
}

/// Whether the clause means the same without the tokens.
bool meansTheSameWithout(const IdleWords& idle, const Clause& clause, const SentenceWords& words) {
  std::vector<Token> tokens(words.tokens.begin() + static_cast<std::ptrdiff_t>(clause.begin),
                            words.tokens.begin() + static_cast<std::ptrdiff_t>(clause.end));
  tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(idle.begin - clause.begin),
               tokens.begin() + static_cast<std::ptrdiff_t>(idle.end - clause.begin));
  // A comma before and one behind.
  for (std::size_t at = tokens.size(); at-- > 0;) {
    const bool border = at == 0 || at + 1 == tokens.size() || isComma(tokens[at - 1]);
    if (isComma(tokens[at]) && border)
      tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(at));
  }
  if (tokens.empty()) return false;
  SentenceWords without(words.grammar, words.text, words.sentence, std::move(tokens));
  PatternRun run(&without);
  for (const IntentInfo& intent : words.grammar.intents) {
    if (meaningOf(intent) != meaningOf(*clause.intent) || !intent.refuse.empty()) continue;
    for (const Automaton& pattern : intent.patterns) {
      if (!run.mayBegin(pattern, 0)) continue;
      const auto ends = run.run(pattern, 0);
      if (ends.empty() || ends.back().at != without.tokens.size()) continue;
      const auto path = run.path(without.tokens.size());
      Clause again = clause;
      again.slots.clear();
      if (path && capture(pattern, *path, &without, &again) && again.meansTheSameAs(clause)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::vector<IdleWords> idleWordsOf(const Clause& clause, SentenceWords* words, PatternRun* run) {
  const auto& tokens = words->tokens;
  const CompiledGrammar& grammar = words->grammar;
  std::vector<bool> is_free;
  std::vector<IdleWords> idle;
  // A second one only stresses the first: "já não há nenhuma".
  const auto first_denial =
      std::find_if(tokens.begin() + static_cast<std::ptrdiff_t>(clause.begin),
                   tokens.begin() + static_cast<std::ptrdiff_t>(clause.end),
                   [&](const Token& token) { return isDenial(token, grammar); });
  for (std::size_t at = clause.begin; at < clause.end; ++at) {
    const bool denies = clause.intent->kind == UtteranceKind::kStatement &&
                        at == static_cast<std::size_t>(first_denial - tokens.begin()) &&
                        !isOfCorrection(at, clause, *words);
    if (!denies && !isThing(tokens[at], grammar) && !isNumber(tokens[at], grammar)) continue;
    if (is_free.empty()) {
      run->run(*clause.pattern, clause.begin);
      const auto path = run->path(clause.end);
      if (!path) return {};
      is_free = freeTokens(clause, tokens.size(), *path);
    }
    if (!is_free[at]) continue;
    std::size_t first = at;
    const std::size_t least = idle.empty() ? clause.begin : idle.back().end;
    while (first > least && is_free[first - 1] && at - first < kLongest) --first;
    // The longest phrase up to the word.
    for (; first <= at; ++first) {
      const IdleWords phrase{first, at + 1};
      if (isComma(tokens[first]) || !(denies || places(*words, first, at))) continue;
      if (!meansTheSameWithout(phrase, clause, *words)) continue;
      idle.push_back(phrase);
      break;
    }
  }
  return idle;
}

std::vector<IdleWords> idleWordsBetween(const std::vector<IdleWords>& clauses,
                                        const SentenceWords& words) {
  std::vector<IdleWords> idle;
  const auto isInside = [&](std::size_t at) {
    return std::any_of(clauses.begin(), clauses.end(), [at](const IdleWords& clause) {
      return clause.begin <= at && at < clause.end;
    });
  };
  for (std::size_t at = 0; at < words.tokens.size();) {
    const std::size_t begin = at;
    bool tells = false;
    while (at < words.tokens.size() && !isInside(at) && !words.isComma(at)) {
      tells = tells || isThing(words.tokens[at], words.grammar) ||
              isNumber(words.tokens[at], words.grammar);
      ++at;
    }
    if (tells) idle.push_back({begin, at});
    if (at == begin) ++at;
  }
  return idle;
}

}  // namespace language
}  // namespace hyselam_topo

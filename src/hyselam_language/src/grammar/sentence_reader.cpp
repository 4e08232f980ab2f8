#include "sentence_reader.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "capture.hpp"
#include "clause.hpp"
#include "clause_borders.hpp"
#include "here_words.hpp"
#include "idle_words.hpp"
#include "matching_costs.hpp"
#include "pattern_run.hpp"
#include "refusal.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Finds the cheapest row of clauses that covers the sentence.
class SentenceReader {
 public:
  SentenceReader(const CompiledGrammar& grammar, const std::string& text, const Sentence& sentence,
                 std::vector<Token> tokens, const std::set<std::string>& expected,
                 const ClauseOptions& options)
      : expected_(expected),
        run_on_(options.run_on),
        explain_(options.explain),
        beginnings_(options.beginnings),
        wanted_ends_(options.ends),
        words_(grammar, text, sentence, std::move(tokens)),
        pattern_run_(&words_, {}, options.explain) {}

  std::vector<Utterance> read() {
    if (words_.isTooLong()) return {refusal(words_, "too_long", words_.sentence.range, "")};
    findClauses();
    const std::size_t n = words_.tokens.size();
    if (wanted_ends_ != nullptr) {
      for (const std::size_t end : *wanted_ends_) {
        if (end <= n && ends_[end].cost < kNever) beginnings_->push_back({end, assemble(end)});
      }
      return {};
    }
    if (beginnings_ != nullptr && n > 0 && ends_[n].cost >= kNever) {
      for (std::size_t end = n; end-- > 1;) {
        if (ends_[end].cost < kNever) beginnings_->push_back({end, assemble(end)});
      }
    }
    return assemble(n);
  }

 private:
  /// The cheapest row of clauses that ends at a token.
  struct Reading {
    int cost = kNever;
    int clause = -1;           ///< the last one; -1: none
    std::size_t begin = 0;     ///< before its fillers
    std::size_t from_end = 0;  ///< where the clause before it ended
    bool ambiguous = false;
    int other = -1;  ///< then what the last clause may be as well
  };

  void findClauses() {
    const std::size_t n = words_.tokens.size();
    ends_.assign(n + 1, {});
    // Begin of a clause: cost, and the end of the clause before.
    std::vector<std::pair<int, std::size_t>> begins(n + 1, {kNever, 0});
    begins[0] = {0, 0};
    for (std::size_t at = 0; at <= n; ++at) {
      if (ends_[at].cost < kNever && at < n) {
        for (const auto& [to, cost] : separatorsAt(words_, at)) {
          const int total = ends_[at].cost + cost;
          if (total < begins[to].first) begins[to] = {total, at};
        }
        if (run_on_ && at > 0 && ends_[at].cost + kRunOnCost < begins[at].first) {
          begins[at] = {ends_[at].cost + kRunOnCost, at};
        }
      }
      if (begins[at].first >= kNever || at == n) continue;
      for (const Entry& entry : entriesAt(words_, at)) {
        const int before = begins[at].first + entry.cost + kClauseCost;
        clausesAt(entry, [&](const Clause& clause) {
          for (const auto& [end, cost] : exitsAt(words_, clause.end)) {
            addReading(before + clause.cost + cost, end, at, begins[at].second, clause);
          }
        });
      }
    }
  }

  void addReading(int cost, std::size_t end, std::size_t begin, std::size_t from_end,
                  const Clause& clause) {
    Reading& best = ends_[end];
    if (cost > best.cost) return;
    if (cost == best.cost) {
      const Clause& other = clauses_[static_cast<std::size_t>(best.clause)];
      if (clause.meansTheSameAs(other) || best.ambiguous) return;
      clauses_.push_back(clause);
      best.ambiguous = true;
      best.other = static_cast<int>(clauses_.size()) - 1;
      return;
    }
    clauses_.push_back(clause);
    best = {cost, static_cast<int>(clauses_.size()) - 1, begin, from_end, false, -1};
  }

  /// Calls f(clause) for all that may begin there.
  template <typename F>
  void clausesAt(const Entry& entry, F&& f) {
    for (const IntentInfo& intent : words_.grammar.intents) {
      if (!isPossible(intent, entry)) continue;
      // "Isto é ótimo" is not "isto" and "é" and "ótimo".
      if (run_on_ && intent.kind == UtteranceKind::kAnswer) continue;
      const int bonus = expected_.count(intent.name) != 0 ? kExpectedBonus : 0;
      for (const Automaton& pattern : intent.patterns) {
        if (!pattern_run_.mayBegin(pattern, entry.at)) continue;
        for (const PatternRun::End& end : pattern_run_.run(pattern, entry.at)) {
          const auto path = pattern_run_.path(end.at);
          if (!path) continue;
          Clause clause;
          clause.intent = &intent;
          clause.pattern = &pattern;
          clause.begin = entry.at;
          clause.end = end.at;
          clause.cost = end.cost + intent.cost - bonus;
          clause.correction = entry.correction;
          clause.tied = end.tied;
          if (!capture(pattern, *path, &words_, &clause)) continue;
          if (deniesBeforeComma(clause)) continue;
          if (clause.correction || !clause.only_corrects) f(clause);
        }
      }
    }
  }

  /// "À esquerda, não, é à direita" corrects, "à esquerda, não é à direita" denies.
  bool deniesBeforeComma(const Clause& clause) const {
    const bool denies = std::any_of(clause.slots.begin(), clause.slots.end(), [](const Slot& slot) {
      return slot.name == "denied" || slot.name == "was_side" ||
             (slot.name == "instead" && slot.names.empty());
    });
    for (std::size_t at = clause.begin; denies && at + 1 < clause.end; ++at) {
      const auto code = words_.grammar.refusing_words.find(words_.tokens[at].folded);
      const bool no = code != words_.grammar.refusing_words.end() && code->second == "denial";
      if (no && isComma(words_.tokens[at + 1])) return true;
    }
    return false;
  }

  bool isPossible(const IntentInfo& intent, const Entry& entry) const {
    if (intent.only_correction && !entry.correction) return false;
    if (intent.only_expected && expected_.count(intent.name) == 0) return false;
    const bool asks =
        intent.kind == UtteranceKind::kQuestion || intent.kind == UtteranceKind::kCommand;
    if (words_.sentence.is_question && !asks) return false;
    return !entry.correction || intent.kind == UtteranceKind::kStatement;
  }

  /// Of the tokens before `end`.
  std::vector<Utterance> assemble(std::size_t end) {
    const Reading& whole = ends_[end];
    const auto& tokens = words_.tokens;
    if (tokens.empty() || whole.cost >= kNever) {
      return {explain_ ? whyNot(words_, pattern_run_.furthest()) : unexplained()};
    }
    std::vector<Utterance> utterances;
    std::vector<IdleWords> ranges{{end, tokens.size()}};
    for (const Reading* reading = &whole;;) {
      const Clause& clause = clauses_[static_cast<std::size_t>(reading->clause)];
      const TextRange range{tokens[clause.begin].range.begin, tokens[clause.end - 1].range.end};
      if (!clause.intent->refuse.empty()) return {refusal(words_, clause.intent->refuse, range)};
      if (clause.tied) return {refusal(words_, "ambiguous", range)};
      if (reading->ambiguous) {
        const Clause& other = clauses_[static_cast<std::size_t>(reading->other)];
        return {
            refusal(words_, "ambiguous", range, examplesOf(*clause.intent, *other.intent, range))};
      }
      utterances.push_back(utteranceOf(clause, range));
      addHere(clause, reading->from_end, &utterances.back());
      leaveOut(idleWordsOf(clause, &words_, &pattern_run_), &utterances.back());
      ranges.push_back({clause.begin, clause.end});
      if (reading->begin == 0) break;
      reading = &ends_[reading->from_end];
    }
    std::reverse(utterances.begin(), utterances.end());
    for (const IdleWords& idle : idleWordsBetween(ranges, words_)) {
      utterances.front().left_out.push_back(textOf(idle));
    }
    return utterances;
  }

  /// Slot `here` of a statement: "here on your left".
  void addHere(const Clause& clause, std::size_t from, Utterance* utterance) const {
    if (utterance->kind != UtteranceKind::kStatement || utterance->find("here") != nullptr ||
        !isToldHere(clause, from, words_)) {
      return;
    }
    Slot here;
    here.name = here.type = "here";
    here.word = "yes";
    here.range = utterance->find("side")->range;
    utterance->slots.push_back(std::move(here));
  }

  std::string textOf(const IdleWords& idle) const {
    return words_.textOf(
        {words_.tokens[idle.begin].range.begin, words_.tokens[idle.end - 1].range.end});
  }

  /// Statements without such words are asked about.
  void leaveOut(const std::vector<IdleWords>& all, Utterance* utterance) const {
    if (all.empty()) return;
    std::string rest;
    std::size_t from = utterance->range.begin;
    for (const IdleWords& idle : all) {
      utterance->left_out.push_back(textOf(idle));
      const std::size_t begin = words_.tokens[idle.begin].range.begin;
      rest += words_.textOf({from, begin});
      from = words_.tokens[idle.end - 1].range.end;
    }
    rest += words_.textOf({from, utterance->range.end});
    if (utterance->kind == UtteranceKind::kStatement && !utterance->correction) {
      utterance->to_confirm = asSentence(rest);
    }
  }

  Utterance unexplained() const {
    Utterance utterance;
    utterance.range = words_.sentence.range;
    return utterance;
  }

  Utterance utteranceOf(const Clause& clause, TextRange range) const {
    Utterance utterance;
    utterance.kind = clause.intent->kind;
    utterance.intent = clause.intent->as.empty() ? clause.intent->name : clause.intent->as;
    utterance.slots = clause.slots;
    utterance.correction = clause.correction;
    utterance.spelling = clause.spelling;
    utterance.range = range;
    utterance.text = words_.textOf(range);
    return utterance;
  }

  /// What people may say instead: a sentence of each kind.
  std::string examplesOf(const IntentInfo& a, const IntentInfo& b, TextRange range) const {
    if (&a == &b || a.examples.empty() || b.examples.empty()) return words_.textOf(range);
    return "\"" + a.examples.front() + "\", \"" + b.examples.front() + "\"";
  }

  const std::set<std::string>& expected_;
  const bool run_on_;
  const bool explain_;
  std::vector<Beginning>* const beginnings_;
  const std::vector<std::size_t>* const wanted_ends_;
  SentenceWords words_;
  PatternRun pattern_run_;
  std::vector<Reading> ends_;  ///< at each token
  std::vector<Clause> clauses_;
};

}  // namespace

std::vector<Utterance> readClauses(const CompiledGrammar& grammar, const std::string& text,
                                   const Sentence& sentence, std::vector<Token> tokens,
                                   const std::set<std::string>& expected,
                                   const ClauseOptions& options) {
  return SentenceReader(grammar, text, sentence, std::move(tokens), expected, options).read();
}

bool isUnderstood(const std::vector<Utterance>& said) {
  return std::all_of(said.begin(), said.end(), [](const Utterance& u) { return u.understood(); });
}

std::vector<std::string> namesIn(const std::vector<Utterance>& said) {
  std::vector<std::string> names;
  for (const Utterance& utterance : said) {
    for (const Slot& slot : utterance.slots) {
      for (const SaidName& name : slot.names) {
        if (name.reference.empty()) names.push_back(name.text);
      }
    }
  }
  return names;
}

std::vector<Token> tokensWithin(const std::vector<Token>& tokens, TextRange range) {
  std::vector<Token> within;
  std::copy_if(tokens.begin(), tokens.end(), std::back_inserter(within), [&](const Token& token) {
    return range.begin <= token.range.begin && token.range.end <= range.end;
  });
  return within;
}

/// Words of a sentence, some of them left out, as one of its own.
std::string asSentence(const std::string& words) {
  std::string sentence;
  bool apart = false;
  for (const char c : words) {
    const bool space = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    const bool comma = c == ',';
    if (space || comma) {
      if (comma && !sentence.empty() && sentence.back() != ',') sentence += ',';
      apart = true;
      continue;
    }
    if (apart && !sentence.empty()) sentence += ' ';
    apart = false;
    sentence += c;
  }
  while (!sentence.empty() && sentence.back() == ',') sentence.pop_back();
  if (!sentence.empty() && sentence[0] >= 'a' && sentence[0] <= 'z') {
    sentence[0] = static_cast<char>(sentence[0] - 'a' + 'A');
  }
  return sentence + ".";
}

}  // namespace language
}  // namespace hyselam_topo

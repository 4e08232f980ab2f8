#include "matcher.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "matching_costs.hpp"
#include "measures.hpp"
#include "name_finder.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr int kNever = std::numeric_limits<int>::max() / 2;

/// A pattern that fits to the tokens [begin, end).
struct Clause {
  const IntentInfo* intent = nullptr;
  std::size_t begin = 0;
  std::size_t end = 0;
  int cost = 0;
  bool correction = false;
  bool tied = false;  ///< where one name ends and the next begins cannot be told
  std::vector<Slot> slots;
  std::vector<Spelling> spelling;

  bool meansTheSameAs(const Clause& other) const {
    return intent == other.intent && correction == other.correction && slots == other.slots;
  }
};

/// Where words without meaning before a clause lead.
struct Entry {
  std::size_t at = 0;
  int cost = 0;
  bool correction = false;
};

class SentenceReader {
 public:
  SentenceReader(const CompiledGrammar& grammar, const std::string& text, const Sentence& sentence,
                 const std::set<std::string>& expected)
      : grammar_(grammar),
        text_(text),
        sentence_(sentence),
        expected_(expected),
        tokens_(tokenize(text, sentence.range, grammar.tokenRules())),
        names_(grammar, text, tokens_) {}

  std::vector<Utterance> read() {
    if (tokens_.size() > kMaxTokens) {
      return {refusal("too_long", sentence_.range, "")};
    }
    for (const Token& token : tokens_) {
      const bool known = grammar_.known_words.count(token.folded) != 0;
      const bool letters = std::all_of(token.folded.begin(), token.folded.end(),
                                       [](char c) { return (c >= 'a' && c <= 'z') || c == '\''; });
      matches_.push_back(grammar_.vocabulary.matches(token, !known && letters));
    }
    findClauses();
    return assemble();
  }

 private:
  // ---- Clauses, one after another ----

  struct Reading {
    int cost = kNever;
    int clause = -1;           ///< the last one; -1: none
    std::size_t begin = 0;     ///< before its fillers
    std::size_t from_end = 0;  ///< where the clause before it ended
    bool ambiguous = false;
    int other = -1;
  };

  void findClauses() {
    const std::size_t n = tokens_.size();
    ends_.assign(n + 1, {});
    // Begin of a clause: cost, and the end of the clause before.
    std::vector<std::pair<int, std::size_t>> begins(n + 1, {kNever, 0});
    begins[0] = {0, 0};
    for (std::size_t at = 0; at <= n; ++at) {
      if (ends_[at].cost < kNever && at < n) {
        for (const auto& [to, cost] : separatorsAt(at)) {
          const int total = ends_[at].cost + cost;
          if (total < begins[to].first) begins[to] = {total, at};
        }
      }
      if (begins[at].first >= kNever || at == n) continue;
      for (const Entry& entry : entriesAt(at)) {
        const int before = begins[at].first + entry.cost + kClauseCost;
        clausesAt(entry, [&](Clause clause) {
          for (const auto& [end, cost] : exitsAt(clause.end)) {
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

  /// Follows phrases from `at` as far as they go; f(position, cost) for each place on the way.
  template <typename F>
  void followPhrases(std::size_t at, int cost, const std::vector<Phrase>& phrases, int each,
                     int depth, F&& f) const {
    constexpr int kMaxFillers = 4;
    f(at, cost);
    if (depth == kMaxFillers || at >= tokens_.size()) return;
    if (tokens_[at].kind == TokenKind::kComma) {
      followPhrases(at + 1, cost + kCommaCost, phrases, each, depth + 1, f);
      return;
    }
    for (const Phrase& phrase : phrases) {
      const int phrase_cost = phraseCost(phrase, at, matches_);
      // What is misspelt is no mere filler.
      if (phrase_cost < 0 || phrase_cost >= kSlipCost) continue;
      followPhrases(at + phrase.size(), cost + each + phrase_cost, phrases, each, depth + 1, f);
    }
  }

  std::vector<Entry> entriesAt(std::size_t at) const {
    std::map<std::pair<std::size_t, bool>, int> cheapest;
    const auto note = [&](std::size_t to, int cost, bool correction) {
      if (to >= tokens_.size() || tokens_[to].kind == TokenKind::kComma) return;
      const auto [entry, is_new] = cheapest.emplace(std::make_pair(to, correction), cost);
      if (!is_new) entry->second = std::min(entry->second, cost);
    };
    followPhrases(at, 0, grammar_.fillers_before, kFillerCost, 0, [&](std::size_t to, int cost) {
      note(to, cost, false);
      for (const Phrase& phrase : grammar_.corrections) {
        const int phrase_cost = phraseCost(phrase, to, matches_);
        if (phrase_cost < 0 || phrase_cost >= kSlipCost) continue;
        if (deniesWhatFollows(to, to + phrase.size())) continue;
        followPhrases(to + phrase.size(), cost + kFillerCost + phrase_cost, grammar_.fillers_before,
                      kFillerCost, 0,
                      [&](std::size_t behind, int more) { note(behind, more, true); });
      }
    });
    std::vector<Entry> entries;
    for (const auto& [key, cost] : cheapest) entries.push_back({key.first, cost, key.second});
    return entries;
  }

  /// "Não, há uma cozinha ..." corrects what was told, "não há cozinha ..." denies: a word that
  /// does both corrects only before a comma or a definite article.
  bool deniesWhatFollows(std::size_t begin, std::size_t end) const {
    if (end != begin + 1 || end >= tokens_.size() || tokens_[end].kind == TokenKind::kComma) {
      return false;
    }
    const auto code = grammar_.refusing_words.find(tokens_[begin].folded);
    if (code == grammar_.refusing_words.end() || code->second != "denial") return false;
    return std::none_of(
        grammar_.name_types.begin(), grammar_.name_types.end(),
        [&](const NameType& type) { return type.definite.count(tokens_[end].folded) != 0; });
  }

  std::vector<std::pair<std::size_t, int>> exitsAt(std::size_t at) const {
    std::vector<std::pair<std::size_t, int>> exits;
    followPhrases(at, 0, grammar_.fillers_after, kFillerCost, 0, [&](std::size_t to, int cost) {
      if (to == at || to == tokens_.size() || tokens_[to - 1].kind != TokenKind::kComma) {
        exits.emplace_back(to, cost);
      }
    });
    return exits;
  }

  /// Where the next clause may begin behind the words between clauses.
  std::vector<std::pair<std::size_t, int>> separatorsAt(std::size_t at) const {
    std::vector<std::pair<std::size_t, int>> found;
    followPhrases(at, 0, grammar_.clause_separators, kSeparatorCost, 0,
                  [&](std::size_t to, int cost) {
                    if (to > at && to < tokens_.size()) found.emplace_back(to, cost);
                  });
    return found;
  }

  // ---- One clause: a pattern's automaton ----

  struct Cell {
    int generation = 0;
    int cost = kNever;
    int from_state = -1;
    int edge = -1;  ///< -1: something skipped
    std::size_t from_at = 0;
    bool tied = false;  ///< names may be told apart in several ways that cost the same
  };

  template <typename F>
  void clausesAt(const Entry& entry, F&& f) {
    for (const IntentInfo& intent : grammar_.intents) {
      if (intent.only_expected && expected_.count(intent.name) == 0) continue;
      const bool asks =
          intent.kind == UtteranceKind::kQuestion || intent.kind == UtteranceKind::kCommand;
      if (sentence_.is_question && !asks) continue;
      if (entry.correction && intent.kind != UtteranceKind::kStatement) continue;
      for (const Automaton& pattern : intent.patterns) {
        if (!mayBegin(pattern, entry.at)) continue;
        run(pattern, entry.at, [&](std::size_t end, int cost) {
          Clause clause;
          clause.intent = &intent;
          clause.begin = entry.at;
          clause.end = end;
          clause.cost =
              cost + intent.cost - (expected_.count(intent.name) != 0 ? kExpectedBonus : 0);
          clause.correction = entry.correction;
          clause.tied = cell(pattern, end, pattern.accept).tied;
          if (trace(pattern, end, &clause)) f(clause);
        });
      }
    }
  }

  bool mayBegin(const Automaton& pattern, std::size_t at) const {
    const auto isOneOf = [&](std::size_t token, const std::vector<int>& words) {
      return std::any_of(matches_[token].begin(), matches_[token].end(), [&](const auto& match) {
        return std::binary_search(words.begin(), words.end(), match.word);
      });
    };
    if (!pattern.first_words.empty()) return isOneOf(at, pattern.first_words);
    if (pattern.needed_words.empty()) return true;
    for (std::size_t token = at; token < tokens_.size(); ++token) {
      if (isOneOf(token, pattern.needed_words)) return true;
    }
    return false;
  }

  /// Where the name proper begins that an edge took.
  std::size_t nameBegin(const Automaton& pattern, const Cell& way, std::size_t end) {
    const Edge& edge =
        pattern
            .states[static_cast<std::size_t>(way.from_state)][static_cast<std::size_t>(way.edge)];
    for (const FoundName& name : names_.namesAt(way.from_at, static_cast<std::size_t>(edge.b))) {
      if (name.end == end) return name.name.range.begin;
    }
    return 0;
  }

  Cell& cell(const Automaton& pattern, std::size_t at, int state) {
    Cell& c = cells_[at * pattern.states.size() + static_cast<std::size_t>(state)];
    if (c.generation != generation_) {
      c = {};
      c.generation = generation_;
    }
    return c;
  }

  void reach(const Automaton& pattern, std::size_t at, int state, const Cell& from) {
    Cell& c = cell(pattern, at, state);
    const auto isName = [&](const Cell& way) {
      return way.edge >= 0 && pattern.states[static_cast<std::size_t>(way.from_state)]
                                            [static_cast<std::size_t>(way.edge)]
                                                .kind == EdgeKind::kName;
    };
    const bool tie = from.cost == c.cost && from.from_at != c.from_at && isName(c) &&
                     isName(from) && nameBegin(pattern, c, at) != nameBegin(pattern, from, at);
    if (tie && !c.tied) {
      c.tied = true;
      active_[at].push_back(state);
    }
    if (from.cost >= c.cost) return;
    c = from;
    c.generation = generation_;
    active_[at].push_back(state);
  }

  /// Calls f(end, cost) wherever the pattern fits.
  template <typename F>
  void run(const Automaton& pattern, std::size_t begin, F&& f) {
    const std::size_t n = tokens_.size();
    ++generation_;
    if (cells_.size() < (n + 1) * pattern.states.size()) {
      cells_.resize((n + 1) * pattern.states.size());
    }
    active_.resize(n + 1);
    for (auto& states : active_) states.clear();
    reach(pattern, begin, 0, {generation_, 0, -1, -1, begin, false});
    for (std::size_t at = begin; at <= n; ++at) {
      // States are put behind the list again when a cheaper way to them is found.
      for (std::size_t i = 0; i < active_[at].size(); ++i) {
        const int state = active_[at][i];
        const int cost = cell(pattern, at, state).cost;
        const bool tied = cell(pattern, at, state).tied;
        if (at > begin && at < n && mayBeSkipped(at)) {
          const bool comma = tokens_[at].kind == TokenKind::kComma;
          reach(pattern, at + 1, state,
                {generation_, cost + (comma ? kCommaCost : kInnerCost), state, -1, at, tied});
        }
        const auto& edges = pattern.states[static_cast<std::size_t>(state)];
        for (std::size_t e = 0; e < edges.size(); ++e) {
          follow(pattern, edges[e], at, {generation_, cost, state, static_cast<int>(e), at, tied});
        }
      }
      const int cost = cell(pattern, at, pattern.accept).cost;
      if (at > begin && cost < kNever) f(at, cost);
      if (at > begin && !active_[at].empty()) furthest_ = std::max(furthest_, at);
    }
  }

  bool mayBeSkipped(std::size_t at) const {
    if (tokens_[at].kind == TokenKind::kComma) return true;
    return std::any_of(matches_[at].begin(), matches_[at].end(), [&](const auto& match) {
      return match.cost < kSlipCost && grammar_.fillers_inner.count(match.word) != 0;
    });
  }

  void follow(const Automaton& pattern, const Edge& edge, std::size_t at, Cell next) {
    const int cost = next.cost;
    const auto go = [&](std::size_t end, int more) {
      next.cost = cost + more;
      reach(pattern, end, edge.to, next);
    };
    if (edge.kind == EdgeKind::kSkip || edge.kind == EdgeKind::kBegin ||
        edge.kind == EdgeKind::kValue) {
      go(at, 0);
      return;
    }
    if (at >= tokens_.size()) return;
    switch (edge.kind) {
      case EdgeKind::kWord:
        for (const auto& match : matches_[at]) {
          if (match.word == edge.a) go(at + 1, match.cost);
        }
        break;
      case EdgeKind::kComma:
        if (tokens_[at].kind == TokenKind::kComma) go(at + 1, 0);
        break;
      case EdgeKind::kName:
        for (const FoundName& name : names_.namesAt(at, static_cast<std::size_t>(edge.b))) {
          go(name.end, name.cost);
        }
        break;
      case EdgeKind::kCount:
        for (const FoundNumber& number : numbersAt(at, grammar_, tokens_)) {
          if (isCount(number.value)) go(number.end, 0);
        }
        break;
      case EdgeKind::kNumber:
        for (const FoundNumber& number : numbersAt(at, grammar_, tokens_)) go(number.end, 0);
        break;
      case EdgeKind::kQuantity:
        for (const FoundMeasure& measure : measures(edge, at)) go(measure.end, measure.cost);
        break;
      default:
        break;
    }
  }

  static bool isCount(double value) {
    return value >= 1.0 && value <= 1e6 && value == std::floor(value);
  }

  std::vector<FoundMeasure> measures(const Edge& edge, std::size_t at) const {
    return measuresAt(at, grammar_.quantities[static_cast<std::size_t>(edge.b)], grammar_, tokens_,
                      matches_);
  }

  // ---- What a fitting pattern has captured ----

  /// A captured number whose unit may stand with another one: "6 by 8 metres".
  struct OpenMeasure {
    std::size_t slot = 0;
    int quantity = 0;
    FoundMeasure measure;
  };

  /// False for a way that ends with something skipped: it ends before that, too.
  bool trace(const Automaton& pattern, std::size_t end, Clause* clause) {
    std::vector<std::pair<std::size_t, Cell>> path;  // where an edge leads, and from where it comes
    std::size_t at = end;
    for (int state = pattern.accept; state >= 0;) {
      const Cell& c = cell(pattern, at, state);
      if (c.from_state < 0) break;
      path.emplace_back(at, c);
      state = c.from_state;
      at = c.from_at;
    }
    for (const auto& [to, c] : path) {
      if (c.from_at == to) continue;
      if (c.edge < 0) return false;
      break;
    }
    std::vector<OpenMeasure> open;
    std::map<int, std::size_t> begins;
    for (auto step = path.rbegin(); step != path.rend(); ++step) {
      const Cell& c = step->second;
      if (c.edge < 0) continue;
      const Edge& edge =
          pattern.states[static_cast<std::size_t>(c.from_state)][static_cast<std::size_t>(c.edge)];
      capture(pattern, edge, c.from_at, step->first, &begins, &open, clause);
    }
    return resolveUnits(open, clause);
  }

  Slot& slotOf(const Automaton& pattern, int number, std::size_t from, std::size_t to,
               Clause* clause) const {
    const SlotType& type = pattern.slots[static_cast<std::size_t>(number)];
    const TextRange range{
        tokens_[std::min(from, tokens_.size() - 1)].range.begin,
        to > from ? tokens_[to - 1].range.end : tokens_[from > 0 ? from - 1 : 0].range.end};
    for (Slot& slot : clause->slots) {
      if (slot.name != type.name) continue;
      slot.range.end = std::max(slot.range.end, range.end);
      return slot;
    }
    clause->slots.push_back({});
    Slot& slot = clause->slots.back();
    slot.name = type.name;
    slot.type = type.type;
    slot.range = range;
    return slot;
  }

  void capture(const Automaton& pattern, const Edge& edge, std::size_t from, std::size_t to,
               std::map<int, std::size_t>* begins, std::vector<OpenMeasure>* open, Clause* clause) {
    switch (edge.kind) {
      case EdgeKind::kWord: {
        const std::string& word = grammar_.vocabulary.text(edge.a);
        for (const auto& match : matches_[from]) {
          if (match.word == edge.a && match.cost >= kSlipCost) {
            clause->spelling.push_back({tokens_[from].text, word});
          }
        }
        break;
      }
      case EdgeKind::kName:
        for (const FoundName& name : names_.namesAt(from, static_cast<std::size_t>(edge.b))) {
          if (name.end == to) slotOf(pattern, edge.a, from, to, clause).names.push_back(name.name);
        }
        break;
      case EdgeKind::kCount:
      case EdgeKind::kNumber:
        for (const FoundNumber& number : numbersAt(from, grammar_, tokens_)) {
          if (number.end == to) slotOf(pattern, edge.a, from, to, clause).number = number.value;
        }
        break;
      case EdgeKind::kQuantity: {
        std::optional<FoundMeasure> best;
        for (const FoundMeasure& measure : measures(edge, from)) {
          if (measure.end == to && (!best || measure.cost < best->cost)) best = measure;
        }
        if (!best) break;
        slotOf(pattern, edge.a, from, to, clause).number = best->value;
        const std::string& name = pattern.slots[static_cast<std::size_t>(edge.a)].name;
        for (std::size_t i = 0; i < clause->slots.size(); ++i) {
          if (clause->slots[i].name == name) open->push_back({i, edge.b, *best});
        }
        break;
      }
      case EdgeKind::kBegin:
        (*begins)[edge.a] = from;
        break;
      case EdgeKind::kValue: {
        const std::string& value = grammar_.values[static_cast<std::size_t>(edge.b)];
        Slot& slot = slotOf(pattern, edge.a, (*begins)[edge.a], to, clause);
        if (grammar_.nameType(slot.type) == nullptr) {
          slot.word = value;
        } else {
          SaidName reference;
          reference.reference = value;
          reference.range = slot.range;
          reference.text = text_.substr(slot.range.begin, slot.range.end - slot.range.begin);
          slot.names.push_back(std::move(reference));
        }
        break;
      }
      default:
        break;
    }
  }

  /// "6 by 8 metres": both are metres. False if a unit is needed and missing.
  bool resolveUnits(const std::vector<OpenMeasure>& open, Clause* clause) const {
    for (const OpenMeasure& each : open) {
      Slot& slot = clause->slots[each.slot];
      double factor = each.measure.factor;
      for (const OpenMeasure& other : open) {
        if (factor <= 0.0 && other.quantity == each.quantity) factor = other.measure.factor;
      }
      if (factor <= 0.0) {
        factor = grammar_.quantities[static_cast<std::size_t>(each.quantity)].default_factor;
        slot.unit_assumed = true;
      }
      if (factor <= 0.0) return false;
      slot.number = each.measure.value * factor;
    }
    return true;
  }

  // ---- The outcome ----

  std::vector<Utterance> assemble() {
    const Reading& whole = ends_.back();
    if (tokens_.empty() || whole.cost >= kNever) return {whyNot()};
    std::vector<Utterance> utterances;
    for (const Reading* reading = &whole;;) {
      const Clause& clause = clauses_[static_cast<std::size_t>(reading->clause)];
      const TextRange range{tokens_[clause.begin].range.begin, tokens_[clause.end - 1].range.end};
      if (!clause.intent->refuse.empty()) {
        return {refusal(clause.intent->refuse, range, textOf(range))};
      }
      if (clause.tied) return {refusal("ambiguous", range, textOf(range))};
      if (reading->ambiguous) {
        const Clause& other = clauses_[static_cast<std::size_t>(reading->other)];
        return {refusal("ambiguous", range, examplesOf(*clause.intent, *other.intent, range))};
      }
      Utterance utterance;
      utterance.kind = clause.intent->kind;
      utterance.intent = clause.intent->name;
      utterance.slots = clause.slots;
      utterance.correction = clause.correction;
      utterance.spelling = clause.spelling;
      utterance.range = range;
      utterance.text = textOf(range);
      utterances.push_back(std::move(utterance));
      if (reading->begin == 0) break;
      reading = &ends_[reading->from_end];
    }
    std::reverse(utterances.begin(), utterances.end());
    return utterances;
  }

  /// What people may say instead: a sentence of each kind.
  std::string examplesOf(const IntentInfo& a, const IntentInfo& b, TextRange range) const {
    if (&a == &b || a.examples.empty() || b.examples.empty()) return textOf(range);
    return "\"" + a.examples.front() + "\", \"" + b.examples.front() + "\"";
  }

  std::string textOf(TextRange range) const {
    return text_.substr(range.begin, range.end - range.begin);
  }

  Utterance refusal(const std::string& code, TextRange culprit, const std::string& word) const {
    Utterance utterance;
    utterance.range = sentence_.range;
    utterance.text = textOf(sentence_.range);
    utterance.reason_code = code;
    utterance.reason = grammar_.reason(code, word);
    utterance.culprit = culprit;
    return utterance;
  }

  Utterance whyNot() const {
    if (tokens_.empty()) return refusal("no_pattern", sentence_.range, textOf(sentence_.range));
    if (sentence_.is_question) {
      return refusal("question", sentence_.range, textOf(sentence_.range));
    }
    for (const Token& token : tokens_) {
      const auto code = grammar_.refusing_words.find(token.folded);
      if (token.kind == TokenKind::kWord && code != grammar_.refusing_words.end()) {
        return refusal(code->second, token.range, token.text);
      }
    }
    for (std::size_t k = 0; k + 1 < tokens_.size(); ++k) {
      const Token &sign = tokens_[k], &number = tokens_[k + 1];
      const bool apart = k == 0 || tokens_[k - 1].range.end < sign.range.begin;
      if (apart && sign.text == "-" && number.kind == TokenKind::kNumber &&
          sign.range.end == number.range.begin) {
        const TextRange range{sign.range.begin, number.range.end};
        return refusal("negative", range, textOf(range));
      }
    }
    // The reason that lies furthest on: there the sentence could not be followed any more.
    constexpr char kPart[] = "part_of_place";
    const NameFailure* failure = nullptr;
    for (const NameFailure& each : names_.failures()) {
      if (each.at + 2 < furthest_ && each.code != kPart) continue;
      if (failure == nullptr || each.at >= failure->at) failure = &each;
    }
    const std::size_t at = std::min(furthest_, tokens_.size() - 1);
    if (failure != nullptr) {
      const Token& token = tokens_[failure->at];
      if (failure->code == kPart) {
        const TextRange range{token.range.begin, tokens_[failure->end - 1].range.end};
        return refusal(failure->code, range, textOf(range));
      }
      return refusal(failure->code, token.range, token.text);
    }
    const TextRange rest{tokens_[at].range.begin, tokens_.back().range.end};
    return refusal("no_pattern", rest, textOf(rest));
  }

  const CompiledGrammar& grammar_;
  const std::string& text_;
  const Sentence& sentence_;
  const std::set<std::string>& expected_;
  const std::vector<Token> tokens_;
  TokenMatches matches_;
  NameFinder names_;

  std::vector<Reading> ends_;
  std::vector<Clause> clauses_;

  std::vector<Cell> cells_;
  std::vector<std::vector<int>> active_;
  int generation_ = 0;
  std::size_t furthest_ = 0;
};

}  // namespace

std::vector<Utterance> readSentence(const CompiledGrammar& grammar, const std::string& text,
                                    const Sentence& sentence,
                                    const std::set<std::string>& expected) {
  return SentenceReader(grammar, text, sentence, expected).read();
}

bool isPlainName(const CompiledGrammar& grammar, const std::string& name, const std::string& type) {
  const auto& types = grammar.name_types;
  const auto found = std::find_if(types.begin(), types.end(),
                                  [&](const NameType& each) { return each.name == type; });
  if (found == types.end()) return false;
  const TokenRules rules = grammar.tokenRules();
  const std::vector<Sentence> sentences = splitSentences(name, rules);
  if (sentences.size() != 1 || sentences[0].range.end != name.size()) return false;
  const std::vector<Token> tokens = tokenize(name, {0, name.size()}, rules);
  if (tokens.empty()) return false;
  NameFinder finder(grammar, name, tokens);
  const auto& names = finder.namesAt(0, static_cast<std::size_t>(found - types.begin()));
  return std::any_of(names.begin(), names.end(), [&](const FoundName& each) {
    return each.end == tokens.size() && each.name.text == name && !each.name.quoted;
  });
}

}  // namespace language
}  // namespace hyselam_topo

#include "pattern_run.hpp"

#include <algorithm>
#include <cmath>

#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {
namespace {

bool isCount(double value) {
  return value >= 1.0 && value <= 1e6 && value == std::floor(value);
}

std::vector<std::vector<int>> wordsOfTokens(const TokenMatches& matches) {
  std::vector<std::vector<int>> words(matches.size());
  for (std::size_t at = 0; at < matches.size(); ++at) {
    for (const Vocabulary::Match& match : matches[at]) words[at].push_back(match.word);
  }
  return words;
}

}  // namespace

PatternRun::PatternRun(SentenceWords* words, std::vector<int> leave_out, bool easily)
    : words_(*words),
      leave_out_(std::move(leave_out)),
      chances_(words->grammar.index, wordsOfTokens(words->matches), easily) {
  for (std::size_t at = 0; at < words_.matches.size(); ++at) skip_costs_.push_back(skipCost(at));
}

std::vector<PatternRun::End> PatternRun::run(const Automaton& pattern, std::size_t begin) {
  const std::size_t n = words_.tokens.size();
  active_.resize(n + 1);
  for (std::size_t at = 0; at <= last_; ++at) active_[at].clear();
  pattern_ = &pattern;
  ++generation_;
  used_ = 0;
  last_ = begin;
  std::vector<End> ends;
  reach(begin, 0, {0, generation_, 0, -1, -1, begin, false});
  for (std::size_t at = begin; at <= last_; ++at) {
    // States are put behind the list again when a cheaper way to them is found.
    for (std::size_t i = 0; i < active_[at].size(); ++i) leave(at, active_[at][i], at == begin);
    if (at == begin) continue;
    const Cell* last = reached(at, pattern.accept);
    if (last != nullptr) ends.push_back({at, last->cost, last->tied});
    if (!active_[at].empty()) furthest_ = std::max(furthest_, at);
  }
  return ends;
}

std::optional<std::vector<PatternRun::Step>> PatternRun::path(std::size_t end) {
  std::vector<Step> steps;
  std::size_t at = end;
  for (int state = pattern_->accept; state >= 0;) {
    const Cell* found = reached(at, state);
    if (found == nullptr || found->from_state < 0) break;
    const Cell& c = *found;
    steps.push_back({c.edge < 0 ? std::nullopt : std::optional<Edge>(edgeOf(c)), c.from_at, at});
    state = c.from_state;
    at = c.from_at;
  }
  const auto last = std::find_if(steps.begin(), steps.end(),
                                 [](const Step& step) { return step.from != step.to; });
  if (last != steps.end() && !last->edge) return std::nullopt;
  std::reverse(steps.begin(), steps.end());
  return steps;
}

std::size_t PatternRun::placeOf(std::uint64_t key) const {
  const std::size_t mask = cells_.size() - 1;
  std::size_t at = (key * 0x9e3779b97f4a7c15ULL >> 32) & mask;
  while (cells_[at].generation == generation_ && cells_[at].key != key) at = (at + 1) & mask;
  return at;
}

PatternRun::Cell& PatternRun::cell(std::size_t at, int state) {
  if (2 * (used_ + 1) > cells_.size()) growTable();
  const std::uint64_t key = keyOf(at, state);
  Cell& c = cells_[placeOf(key)];
  if (c.generation != generation_) {
    c = {};
    c.key = key;
    c.generation = generation_;
    ++used_;
  }
  return c;
}

const PatternRun::Cell* PatternRun::reached(std::size_t at, int state) const {
  const Cell& c = cells_[placeOf(keyOf(at, state))];
  return c.generation == generation_ && c.cost < kNever ? &c : nullptr;
}

void PatternRun::growTable() {
  constexpr std::size_t kFirst = 256;
  std::vector<Cell> before(std::max(kFirst, 2 * cells_.size()));
  before.swap(cells_);
  for (const Cell& c : before) {
    if (c.generation == generation_) cells_[placeOf(c.key)] = c;
  }
}

Edge PatternRun::edgeOf(const Cell& way) const {
  return pattern_->packed.edge(way.from_state, way.edge);
}

bool PatternRun::isName(const Cell& way) const {
  return way.edge >= 0 && edgeOf(way).kind == EdgeKind::kName;
}

/// Where the name proper begins that an edge took.
std::size_t PatternRun::nameBegin(const Cell& way, std::size_t end) {
  for (const FoundName& name : words_.namesAt(way.from_at, edgeOf(way).b)) {
    if (name.end == end) return name.name.range.begin;
  }
  return 0;
}

void PatternRun::reach(std::size_t at, int state, const Cell& from) {
  Cell& c = cell(at, state);
  const bool tie = from.cost == c.cost && from.from_at != c.from_at && isName(c) && isName(from) &&
                   nameBegin(c, at) != nameBegin(from, at);
  if (tie && !c.tied) {
    c.tied = true;
    active_[at].push_back(state);
  }
  if (from.cost >= c.cost) return;
  const std::uint64_t key = c.key;
  c = from;
  c.key = key;
  active_[at].push_back(state);
  last_ = std::max(last_, at);
}

/// Follows all edges from a state. Nothing is skipped before the first token.
void PatternRun::leave(std::size_t at, int state, bool is_first) {
  const Cell& from = cell(at, state);
  const int cost = from.cost;
  const bool tied = from.tied;
  if (!is_first && at < skip_costs_.size() && skip_costs_[at] < kNever) {
    reach(at + 1, state, {0, generation_, cost + skip_costs_[at], state, -1, at, tied});
  }
  if (!is_first && at < leave_out_.size() && leave_out_[at] < kNever) {
    reach(at + 1, state, {0, generation_, cost + leave_out_[at], state, -1, at, tied});
  }
  const auto words = pattern_->packed.wordsOf(state);
  const auto go = [&](const Edge& edge, std::size_t number) {
    follow(edge, at, {0, generation_, cost, state, static_cast<int>(number), at, tied});
  };
  // Sorted: only those of the word that stands here are looked at.
  if (at < words_.tokens.size() && words.size() != 0) {
    for (const auto& match : words_.matches[at]) {
      const auto* each = std::lower_bound(
          words.begin(), words.end(), match.word,
          [](const PackedStates::WordEdge& edge, int word) { return edge.word < word; });
      for (; each != words.end() && each->word == match.word; ++each) {
        go({EdgeKind::kWord, each->to, each->word, -1},
           static_cast<std::size_t>(each - words.begin()));
      }
    }
  }
  std::size_t number = words.size();
  for (const Edge& edge : pattern_->packed.othersOf(state)) go(edge, number++);
}

int PatternRun::skipCost(std::size_t at) const {
  if (words_.isComma(at)) return kCommaCost;
  const auto& matches = words_.matches[at];
  const bool filler = std::any_of(matches.begin(), matches.end(), [&](const auto& match) {
    return match.cost < kSlipCost && words_.grammar.fillers_inner.count(match.word) != 0;
  });
  return filler ? kInnerCost : kNever;
}

int PatternRun::doubt(std::size_t begin, std::size_t end, int type) const {
  if (leave_out_.empty()) return 0;
  const NameType& names = words_.grammar.name_types[static_cast<std::size_t>(type)];
  for (std::size_t at = begin; at < end; ++at) {
    const Token& token = words_.tokens[at];
    const bool sure = token.kind != TokenKind::kWord || names.nouns.count(token.folded) != 0 ||
                      names.titles.count(token.folded) != 0 || (token.starts_upper && at > 0) ||
                      token.folded.find_first_of("0123456789") != std::string::npos;
    if (sure) return 0;
  }
  return kDoubtfulNameCost;
}

void PatternRun::follow(const Edge& edge, std::size_t at, Cell next) {
  const int cost = next.cost;
  const auto go = [&](std::size_t end, int more) {
    next.cost = cost + more;
    reach(end, edge.to, next);
  };
  if (edge.kind == EdgeKind::kSkip || edge.kind == EdgeKind::kBegin ||
      edge.kind == EdgeKind::kValue) {
    go(at, 0);
    return;
  }
  if (at >= words_.tokens.size()) return;
  switch (edge.kind) {
    case EdgeKind::kWord:
      for (const auto& match : words_.matches[at]) {
        if (match.word == edge.a) go(at + 1, match.cost);
      }
      break;
    case EdgeKind::kComma:
      if (words_.isComma(at)) go(at + 1, 0);
      break;
    case EdgeKind::kName:
      for (const FoundName& name : words_.namesAt(at, edge.b)) {
        go(name.end, name.cost + doubt(at, name.end, edge.b));
      }
      break;
    case EdgeKind::kCount:
      for (const FoundNumber& number : words_.numbersAt(at)) {
        if (isCount(number.value) && number.value >= edge.b) go(number.end, 0);
      }
      break;
    case EdgeKind::kNumber:
      for (const FoundNumber& number : words_.numbersAt(at)) go(number.end, 0);
      break;
    case EdgeKind::kQuantity:
      for (const FoundMeasure& measure : words_.measuresAt(at, edge.b)) {
        go(measure.end, measure.cost);
      }
      break;
    default:
      break;
  }
}

}  // namespace language
}  // namespace hyselam_topo

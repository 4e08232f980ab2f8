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

}  // namespace

bool PatternRun::mayBegin(const Automaton& pattern, std::size_t at) const {
  const auto isOneOf = [&](std::size_t token, const std::vector<int>& words) {
    const auto& matches = words_.matches[token];
    return std::any_of(matches.begin(), matches.end(), [&](const auto& match) {
      return std::binary_search(words.begin(), words.end(), match.word);
    });
  };
  if (!pattern.first_words.empty()) return isOneOf(at, pattern.first_words);
  if (pattern.needed_words.empty()) return true;
  for (std::size_t token = at; token < words_.tokens.size(); ++token) {
    if (isOneOf(token, pattern.needed_words)) return true;
  }
  return false;
}

std::vector<PatternRun::End> PatternRun::run(const Automaton& pattern, std::size_t begin) {
  pattern_ = &pattern;
  const std::size_t n = words_.tokens.size();
  ++generation_;
  if (cells_.size() < (n + 1) * pattern.states.size()) {
    cells_.resize((n + 1) * pattern.states.size());
  }
  active_.resize(n + 1);
  for (auto& states : active_) states.clear();
  std::vector<End> ends;
  reach(begin, 0, {generation_, 0, -1, -1, begin, false});
  for (std::size_t at = begin; at <= n; ++at) {
    // States are put behind the list again when a cheaper way to them is found.
    for (std::size_t i = 0; i < active_[at].size(); ++i) leave(at, active_[at][i], at == begin);
    if (at == begin) continue;
    const Cell& last = cell(at, pattern.accept);
    if (last.cost < kNever) ends.push_back({at, last.cost, last.tied});
    if (!active_[at].empty()) furthest_ = std::max(furthest_, at);
  }
  return ends;
}

std::optional<std::vector<PatternRun::Step>> PatternRun::path(std::size_t end) {
  std::vector<Step> steps;
  std::size_t at = end;
  for (int state = pattern_->accept; state >= 0;) {
    const Cell& c = cell(at, state);
    if (c.from_state < 0) break;
    steps.push_back({c.edge < 0 ? nullptr : &edgeOf(c), c.from_at, at});
    state = c.from_state;
    at = c.from_at;
  }
  const auto last = std::find_if(steps.begin(), steps.end(),
                                 [](const Step& step) { return step.from != step.to; });
  if (last != steps.end() && last->edge == nullptr) return std::nullopt;
  std::reverse(steps.begin(), steps.end());
  return steps;
}

PatternRun::Cell& PatternRun::cell(std::size_t at, int state) {
  Cell& c = cells_[at * pattern_->states.size() + static_cast<std::size_t>(state)];
  if (c.generation != generation_) {
    c = {};
    c.generation = generation_;
  }
  return c;
}

const Edge& PatternRun::edgeOf(const Cell& way) const {
  return pattern_
      ->states[static_cast<std::size_t>(way.from_state)][static_cast<std::size_t>(way.edge)];
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
  c = from;
  c.generation = generation_;
  active_[at].push_back(state);
}

/// Follows all edges from a state. Nothing is skipped before the first token.
void PatternRun::leave(std::size_t at, int state, bool is_first) {
  const int cost = cell(at, state).cost;
  const bool tied = cell(at, state).tied;
  if (!is_first && at < words_.tokens.size() && mayBeSkipped(at)) {
    const int skip = words_.isComma(at) ? kCommaCost : kInnerCost;
    reach(at + 1, state, {generation_, cost + skip, state, -1, at, tied});
  }
  if (!is_first && at < leave_out_.size() && leave_out_[at] < kNever) {
    reach(at + 1, state, {generation_, cost + leave_out_[at], state, -1, at, tied});
  }
  const auto& edges = pattern_->states[static_cast<std::size_t>(state)];
  const auto go = [&](std::size_t e) {
    follow(edges[e], at, {generation_, cost, state, static_cast<int>(e), at, tied});
  };
  // Edges for words come first, sorted: only those of the word that stands here are looked at.
  const auto words_end = std::partition_point(
      edges.begin(), edges.end(), [](const Edge& edge) { return edge.kind == EdgeKind::kWord; });
  if (at < words_.tokens.size() && words_end != edges.begin()) {
    for (const auto& match : words_.matches[at]) {
      const auto from = std::lower_bound(edges.begin(), words_end, match.word,
                                         [](const Edge& edge, int word) { return edge.a < word; });
      for (auto each = from; each != words_end && each->a == match.word; ++each) {
        go(static_cast<std::size_t>(each - edges.begin()));
      }
    }
  }
  for (auto e = static_cast<std::size_t>(words_end - edges.begin()); e < edges.size(); ++e) go(e);
}

bool PatternRun::mayBeSkipped(std::size_t at) const {
  if (words_.isComma(at)) return true;
  const auto& matches = words_.matches[at];
  return std::any_of(matches.begin(), matches.end(), [&](const auto& match) {
    return match.cost < kSlipCost && words_.grammar.fillers_inner.count(match.word) != 0;
  });
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

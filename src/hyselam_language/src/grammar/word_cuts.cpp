#include "word_cuts.hpp"

#include <utility>

namespace hyselam_topo {
namespace language {

WordCuts::WordCuts(const Automaton& automaton, const std::vector<bool>& in_list,
                   std::size_t word_count)
    : accept_(automaton.accept), first_(word_count + 1, 0), blocked_(word_count, 0) {
  const std::size_t count = automaton.states.size();
  std::size_t edges = 0;
  for (const auto& of_state : automaton.states) edges += of_state.size();
  ways_.reserve(edges);
  in_.assign(count + 1, 0);
  out_.reserve(count + 1);
  out_.push_back(0);
  for (std::size_t state = 0; state < count; ++state) {
    for (const Edge& e : automaton.states[state]) {
      const bool counts = e.kind == EdgeKind::kWord && !in_list[state];
      if (counts) ++first_[static_cast<std::size_t>(e.a) + 1];
      ways_.push_back({static_cast<int>(state), e.to, counts ? e.a : -1});
      ++in_[static_cast<std::size_t>(e.to) + 1];
    }
    out_.push_back(ways_.size());
  }
  for (std::size_t state = 0; state < count; ++state) in_[state + 1] += in_[state];
  std::vector<std::size_t> next(in_.begin(), in_.end() - 1);
  into_.resize(ways_.size());
  for (std::size_t w = 0; w < ways_.size(); ++w) {
    into_[next[static_cast<std::size_t>(ways_[w].to)]++] = w;
  }
  for (std::size_t word = 0; word < word_count; ++word) first_[word + 1] += first_[word];
  said_.resize(first_.back());
  next.assign(first_.begin(), first_.end() - 1);
  for (std::size_t w = 0; w < ways_.size(); ++w) {
    if (ways_[w].word >= 0) said_[next[static_cast<std::size_t>(ways_[w].word)]++] = w;
  }
}

std::vector<int> WordCuts::words() const {
  std::vector<int> words;
  for (std::size_t word = 0; word < blocked_.size(); ++word) {
    if (first_[word] < first_[word + 1]) words.push_back(static_cast<int>(word));
  }
  return words;
}

bool WordCuts::block() {
  for (std::size_t word = 0; word < blocked_.size(); ++word) {
    blocked_[word] = first_[word] < first_[word + 1] ? 1 : 0;
  }
  ahead_.assign(out_.size() - 1, 0);
  behind_.assign(out_.size() - 1, 0);
  open_.assign(1, 0);
  spread(true, nullptr, &ahead_);
  open_.assign(1, accept_);
  spread(false, nullptr, &behind_);
  return ahead_[static_cast<std::size_t>(accept_)] == 0;
}

bool WordCuts::spread(bool forwards, const Marks* stop, Marks* marks) {
  marked_.clear();
  const auto& rows = forwards ? out_ : in_;
  while (!open_.empty()) {
    const auto state = static_cast<std::size_t>(open_.back());
    open_.pop_back();
    if ((*marks)[state] != 0) continue;
    if (stop != nullptr && (*stop)[state] != 0) {
      open_.clear();
      for (const int each : marked_) (*marks)[static_cast<std::size_t>(each)] = 0;
      return false;
    }
    (*marks)[state] = 1;
    marked_.push_back(static_cast<int>(state));
    for (std::size_t i = rows[state]; i < rows[state + 1]; ++i) {
      const Way& way = ways_[forwards ? i : into_[i]];
      if (passes(way)) open_.push_back(forwards ? way.to : way.from);
    }
  }
  return true;
}

void WordCuts::drop(const std::vector<int>& words) {
  for (const int word : words) {
    if (blocked_[static_cast<std::size_t>(word)] != 0) drop(word);
  }
}

void WordCuts::drop(int word) {
  char& blocked = blocked_[static_cast<std::size_t>(word)];
  blocked = 0;
  const auto w = static_cast<std::size_t>(word);
  open_.clear();
  for (std::size_t i = first_[w]; i < first_[w + 1]; ++i) {
    const Way& way = ways_[said_[i]];
    if (ahead_[static_cast<std::size_t>(way.from)] != 0) open_.push_back(way.to);
  }
  if (!spread(true, &behind_, &ahead_)) {
    blocked = 1;
    return;
  }
  for (std::size_t i = first_[w]; i < first_[w + 1]; ++i) {
    const Way& way = ways_[said_[i]];
    if (behind_[static_cast<std::size_t>(way.to)] != 0) open_.push_back(way.from);
  }
  spread(false, nullptr, &behind_);
}

std::vector<int> WordCuts::blocked() const {
  std::vector<int> words;
  for (std::size_t word = 0; word < blocked_.size(); ++word) {
    if (blocked_[word] != 0) words.push_back(static_cast<int>(word));
  }
  return words;
}

}  // namespace language
}  // namespace hyselam_topo

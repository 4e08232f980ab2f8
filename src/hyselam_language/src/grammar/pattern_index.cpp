#include "pattern_index.hpp"

#include <algorithm>
#include <utility>

namespace hyselam_topo {
namespace language {

void PatternIndex::Groups::add(const std::vector<int>& words, std::size_t of_pattern) {
  if (words.empty()) return;
  for (const int word : words) {
    const auto w = static_cast<std::size_t>(word);
    if (with_word.size() <= w) with_word.resize(w + 1);
    with_word[w].push_back(pattern.size());
  }
  pattern.push_back(of_pattern);
}

void PatternIndex::add(Automaton* pattern) {
  pattern->number = begins_anyhow_.size();
  begins_anyhow_.push_back(pattern->first_words.empty());
  first_.add(pattern->first_words, pattern->number);
  telling_.add(pattern->telling_words, pattern->number);
  needed_.add(pattern->needed_words, pattern->number);
}

PatternChances::PatternChances(const PatternIndex& index, WordsOfTokens words, bool easily)
    : index_(index),
      words_(std::move(words)),
      until_(index.begins_anyhow_.size(), words_.size()),
      begins_(index.begins_anyhow_.size(), 0) {
  const PatternIndex::Groups& groups = easily ? index.telling_ : index.needed_;
  std::vector<std::size_t> last(groups.pattern.size(), 0);
  for (std::size_t at = 0; at < words_.size(); ++at) {
    for (const int word : words_[at]) {
      const auto w = static_cast<std::size_t>(word);
      if (w >= groups.with_word.size()) continue;
      for (const std::size_t group : groups.with_word[w]) last[group] = at + 1;
    }
  }
  for (std::size_t group = 0; group < last.size(); ++group) {
    std::size_t& until = until_[groups.pattern[group]];
    until = std::min(until, last[group]);
  }
}

void PatternChances::lookAt(std::size_t at) {
  looked_at_ = at + 1;
  for (const int word : words_[at]) {
    const auto w = static_cast<std::size_t>(word);
    if (w >= index_.first_.with_word.size()) continue;
    for (const std::size_t group : index_.first_.with_word[w]) {
      begins_[index_.first_.pattern[group]] = at + 1;
    }
  }
}

bool PatternChances::mayBegin(const Automaton& pattern, std::size_t at) {
  if (at >= until_[pattern.number]) return false;
  if (index_.begins_anyhow_[pattern.number]) return true;
  if (looked_at_ != at + 1) lookAt(at);
  return begins_[pattern.number] == at + 1;
}

}  // namespace language
}  // namespace hyselam_topo

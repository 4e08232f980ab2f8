// Words that a pattern cannot do without: each way through it has one of them.
#pragma once

#include <cstddef>
#include <vector>

#include "automaton.hpp"

namespace hyselam_topo {
namespace language {

class WordCuts {
 public:
  /// `in_list`: states between the names of a list, whose words do not count. `word_count`: more
  /// than any word's number. The automaton must outlive this.
  WordCuts(const Automaton& automaton, const std::vector<bool>& in_list, std::size_t word_count);

  /// All words that count, sorted.
  std::vector<int> words() const;
  /// Blocks all words. Whether no way through the pattern is left.
  bool block();
  /// Lets these words pass again, one after the other, where no way opens by that.
  void drop(const std::vector<int>& words);
  /// Those that are blocked, sorted.
  std::vector<int> blocked() const;

 private:
  struct Way {
    int from = 0;
    int to = 0;
    int word = -1;  ///< -1: passes always
  };
  using Marks = std::vector<char>;

  bool passes(const Way& way) const {
    return way.word < 0 || blocked_[static_cast<std::size_t>(way.word)] == 0;
  }
  /// Follows ways from the open states as far as they pass; `stop`: states that must not be met.
  /// Marks what it comes to; nothing is marked, and it is false, if it had to stop.
  bool spread(bool forwards, const Marks* stop, Marks* marks);
  void drop(int word);

  const int accept_;
  std::vector<Way> ways_;                     ///< by the state that they leave
  std::vector<std::size_t> out_, in_, into_;  ///< rows of ways, `into_` in the order of `in_`
  std::vector<std::size_t> first_, said_;     ///< ways of word w: said_[first_[w]] to first_[w + 1]
  Marks blocked_;                             ///< of each word
  Marks ahead_;                     ///< states that the beginning leads to without blocked words
  Marks behind_;                    ///< states that lead to the end without them
  std::vector<int> open_, marked_;  ///< of spread(), kept from call to call
};

}  // namespace language
}  // namespace hyselam_topo

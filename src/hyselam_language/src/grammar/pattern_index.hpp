// Which patterns of a grammar have a chance in a sentence, by the words that are said.
#pragma once

#include <cstddef>
#include <vector>

#include "automaton.hpp"

namespace hyselam_topo {
namespace language {

/// Words to the patterns that begin with them or need them.
class PatternIndex {
 public:
  /// Numbers the pattern.
  void add(Automaton* pattern);

 private:
  friend class PatternChances;
  /// Groups of words of one pattern each.
  struct Groups {
    std::vector<std::vector<std::size_t>> with_word;  ///< of each word
    std::vector<std::size_t> pattern;                 ///< of each group
    void add(const std::vector<int>& words, std::size_t of_pattern);
  };
  Groups first_, telling_, needed_;
  std::vector<bool> begins_anyhow_;  ///< of each pattern
};

/// Of one sentence.
class PatternChances {
 public:
  /// The words that each token may stand for.
  using WordsOfTokens = std::vector<std::vector<int>>;
  /// `easily`: one of all the words that tell a pattern is enough, to see how far it is followed.
  /// Otherwise all that it needs must be there. The index must outlive this.
  PatternChances(const PatternIndex& index, WordsOfTokens words, bool easily);

  /// Whether a pattern may begin at a token and come to an end. Quickest for one token after the
  /// other.
  bool mayBegin(const Automaton& pattern, std::size_t at);

 private:
  void lookAt(std::size_t at);

  const PatternIndex& index_;
  const WordsOfTokens words_;
  std::vector<std::size_t> until_;  ///< of each pattern: where it may begin no more
  std::vector<std::size_t>
      begins_;                 ///< of each pattern: 1 + the last token looked at with a first word
  std::size_t looked_at_ = 0;  ///< 1 + that token; 0: none
};

}  // namespace language
}  // namespace hyselam_topo

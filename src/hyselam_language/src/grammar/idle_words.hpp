// Words that a pattern or a filler has taken and that change nothing of what the clause means,
// though they tell something by themselves: "on the right[, just after the fire door]". Whoever
// takes the clause down must tell that they are left out.
#pragma once

#include <vector>

#include "clause.hpp"
#include "pattern_run.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// Tokens [begin, end).
struct IdleWords {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Runs of words of the clause with a thing, a number or a denial without which its pattern gives
/// the same meaning, in their order. `run` is one over the words in which the clause was found.
std::vector<IdleWords> idleWordsOf(const Clause& clause, SentenceWords* words, PatternRun* run);

/// Runs of words with a thing or a number outside all clauses, whose tokens are [begin, end).
std::vector<IdleWords> idleWordsBetween(const std::vector<IdleWords>& clauses,
                                        const SentenceWords& words);

}  // namespace language
}  // namespace hyselam_topo

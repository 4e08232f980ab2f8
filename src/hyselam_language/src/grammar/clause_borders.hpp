// Words without meaning around clauses: fillers before and behind them, words that say that a
// clause corrects, and what separates two of them.
#pragma once

#include <utility>
#include <vector>

#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// Where words before a clause lead.
struct Entry {
  std::size_t at = 0;  ///< the clause's first token
  int cost = 0;
  bool correction = false;
};

/// Where words behind a clause lead: token and cost.
using Exits = std::vector<std::pair<std::size_t, int>>;

/// The ways from token `at` over fillers and corrections into a clause, each at its least cost.
std::vector<Entry> entriesAt(const SentenceWords& words, std::size_t at);

/// The ways out of a clause that ends before `at`.
Exits exitsAt(const SentenceWords& words, std::size_t at);

/// Where the next clause may begin behind the words between clauses.
Exits separatorsAt(const SentenceWords& words, std::size_t at);

}  // namespace language
}  // namespace hyselam_topo

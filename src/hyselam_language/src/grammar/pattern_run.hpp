// One pattern over the tokens of a sentence: the cheapest way of its automaton to each of its ends
// (dynamic programming over tokens and states).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "automaton.hpp"
#include "pattern_index.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// More than any way costs.
constexpr int kNever = std::numeric_limits<int>::max() / 2;

class PatternRun {
 public:
  /// `words` must outlive this. `leave_out`: what it costs to leave out each token, kNever for
  /// those that must stay; empty: only fillers and commas may be left out. `easily`: see
  /// PatternChances.
  explicit PatternRun(SentenceWords* words, std::vector<int> leave_out = {}, bool easily = false);

  /// Whether the pattern has a chance there: the words that it needs are said.
  bool mayBegin(const Automaton& pattern, std::size_t at) { return chances_.mayBegin(pattern, at); }

  /// A clause that the pattern fits to.
  struct End {
    std::size_t at = 0;  ///< behind its last token
    int cost = 0;
    bool tied = false;  ///< names may be told apart in several ways that cost the same
  };
  /// Where the pattern fits from token `begin` on, the nearest first. `pattern` must outlive
  /// path().
  std::vector<End> run(const Automaton& pattern, std::size_t begin);

  /// An edge that consumed the tokens [from, to).
  struct Step {
    std::optional<Edge> edge;  ///< none: something skipped
    std::size_t from = 0;
    std::size_t to = 0;
  };
  /// The cheapest way of the last run to an end. Nothing for one that ends with something skipped:
  /// it ends before that, too.
  std::optional<std::vector<Step>> path(std::size_t end);

  /// The last token that any run has come to.
  std::size_t furthest() const { return furthest_; }

 private:
  /// How a state is reached at a token.
  struct Cell {
    std::uint64_t key = 0;  ///< of token and state
    int generation = 0;     ///< of an earlier run: not reached
    int cost = kNever;
    int from_state = -1;
    int edge = -1;  ///< -1: something skipped
    std::size_t from_at = 0;
    bool tied = false;
  };

  std::uint64_t keyOf(std::size_t at, int state) const {
    return at * pattern_->packed.size() + static_cast<std::size_t>(state);
  }
  /// Where the cell of a key is, or the free one where it shall be.
  std::size_t placeOf(std::uint64_t key) const;
  /// Holds until the next call.
  Cell& cell(std::size_t at, int state);
  /// Nothing for a state that is not reached.
  const Cell* reached(std::size_t at, int state) const;
  void growTable();
  Edge edgeOf(const Cell& way) const;
  bool isName(const Cell& way) const;
  std::size_t nameBegin(const Cell& way, std::size_t end);
  void reach(std::size_t at, int state, const Cell& from);
  void leave(std::size_t at, int state, bool is_first);
  void follow(const Edge& edge, std::size_t at, Cell next);
  int skipCost(std::size_t at) const;
  /// More for a name that only its place in the sentence makes one, if others may be left out.
  int doubt(std::size_t begin, std::size_t end, int type) const;

  SentenceWords& words_;
  const std::vector<int> leave_out_;
  PatternChances chances_;
  const Automaton* pattern_ = nullptr;
  std::vector<Cell> cells_;               ///< a table with open addressing, kept for all runs
  std::size_t used_ = 0;                  ///< cells of this run
  std::vector<std::vector<int>> active_;  ///< states to go on from, at each token
  int generation_ = 0;
  std::size_t furthest_ = 0;
  std::size_t last_ = 0;         ///< the last token of this run
  std::vector<int> skip_costs_;  ///< of each token, kNever for those that must stay
};

}  // namespace language
}  // namespace hyselam_topo

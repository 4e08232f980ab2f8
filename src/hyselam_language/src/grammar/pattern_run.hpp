// One pattern over the tokens of a sentence: the cheapest way of its automaton to each of its ends
// (dynamic programming over tokens and states).
#pragma once

#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "automaton.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// More than any way costs.
constexpr int kNever = std::numeric_limits<int>::max() / 2;

class PatternRun {
 public:
  /// `words` must outlive this. `leave_out`: what it costs to leave out each token, kNever for
  /// those that must stay; empty: only fillers and commas may be left out.
  explicit PatternRun(SentenceWords* words, std::vector<int> leave_out = {})
      : words_(*words), leave_out_(std::move(leave_out)) {}

  /// Whether the pattern has a chance there: a word that it needs is said.
  bool mayBegin(const Automaton& pattern, std::size_t at) const;

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
    const Edge* edge = nullptr;  ///< none: something skipped
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
    int generation = 0;  ///< of an earlier run: not reached
    int cost = kNever;
    int from_state = -1;
    int edge = -1;  ///< -1: something skipped
    std::size_t from_at = 0;
    bool tied = false;
  };

  Cell& cell(std::size_t at, int state);
  const Edge& edgeOf(const Cell& way) const;
  bool isName(const Cell& way) const;
  std::size_t nameBegin(const Cell& way, std::size_t end);
  void reach(std::size_t at, int state, const Cell& from);
  void leave(std::size_t at, int state, bool is_first);
  void follow(const Edge& edge, std::size_t at, Cell next);
  bool mayBeSkipped(std::size_t at) const;
  /// More for a name that only its place in the sentence makes one, if others may be left out.
  int doubt(std::size_t begin, std::size_t end, int type) const;

  SentenceWords& words_;
  const std::vector<int> leave_out_;
  const Automaton* pattern_ = nullptr;
  std::vector<Cell> cells_;
  std::vector<std::vector<int>> active_;  ///< states to go on from, at each token
  int generation_ = 0;
  std::size_t furthest_ = 0;
};

}  // namespace language
}  // namespace hyselam_topo

// A sentence pattern as an automaton over tokens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hyselam_topo {
namespace language {

enum class EdgeKind : std::uint8_t {
  kSkip,      ///< nothing
  kWord,      ///< the word `a`
  kComma,     ///< a comma
  kName,      ///< a name of type `b` into slot `a`
  kCount,     ///< a whole number >= 1, and >= `b`, into slot `a`
  kNumber,    ///< a number into slot `a`
  kQuantity,  ///< a number with a unit of quantity `b` into slot `a`
  kBegin,     ///< slot `a` of a word class begins
  kValue      ///< slot `a` gets the value `b`
};

struct Edge {
  EdgeKind kind = EdgeKind::kSkip;
  int to = 0;
  int a = -1;
  int b = -1;
};

struct SlotType {
  std::string name;
  std::string type;
  bool is_list = false;
};

/// The states of an automaton close together in memory, as sentences are followed through them:
/// most of the time of a sentence was waiting for edges that lay far apart.
class PackedStates {
 public:
  struct WordEdge {
    int word = 0;
    int to = 0;
  };
  /// Some of a row.
  template <typename T>
  struct Row {
    const T* first = nullptr;
    const T* last = nullptr;
    const T* begin() const { return first; }
    const T* end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };

  PackedStates() = default;
  /// In each state edges of words come first.
  explicit PackedStates(const std::vector<std::vector<Edge>>& states);

  std::size_t size() const { return begins_.empty() ? 0 : begins_.size() - 1; }
  /// Those of words, in their order ...
  Row<WordEdge> wordsOf(int state) const {
    const auto s = static_cast<std::size_t>(state);
    return {words_.data() + begins_[s].word, words_.data() + begins_[s + 1].word};
  }
  /// ... and the others behind them.
  Row<Edge> othersOf(int state) const {
    const auto s = static_cast<std::size_t>(state);
    return {others_.data() + begins_[s].other, others_.data() + begins_[s + 1].other};
  }
  /// By its number among all edges of the state.
  Edge edge(int state, int number) const {
    const auto words = wordsOf(state);
    const auto at = static_cast<std::size_t>(number);
    if (at >= words.size()) return *(othersOf(state).begin() + (at - words.size()));
    const WordEdge& word = *(words.begin() + at);
    return {EdgeKind::kWord, word.to, word.word, -1};
  }

 private:
  struct Begin {
    std::uint32_t word = 0;
    std::uint32_t other = 0;
  };
  std::vector<Begin> begins_;  ///< of each state; one more behind the last
  std::vector<WordEdge> words_;
  std::vector<Edge> others_;
};

/// No cycle consumes nothing.
struct Automaton {
  std::vector<std::vector<Edge>> states;  ///< the first is the beginning; none once it is packed
  PackedStates packed;                    ///< what a sentence is followed through
  int accept = 0;
  std::vector<SlotType> slots;
  /// Words one of which must come first; empty if a name or number may.
  std::vector<int> first_words;
  /// Words one of which must come somewhere; empty if names and numbers alone may fit, or if the
  /// first words tell enough. Sorted, as are the first words.
  std::vector<int> telling_words;
  /// Fewer and rarer words, one of which must come somewhere. Sorted, too.
  std::vector<int> needed_words;
  std::size_t number = 0;  ///< among all patterns of the grammar

  /// To be done once, when it is complete.
  void pack() {
    packed = PackedStates(states);
    states = {};
  }
};

/// All edges of an automaton in one row: those of state s are edges[begin[s]] to edges[begin[s+1]].
struct EdgeTable {
  explicit EdgeTable(const Automaton& automaton) {
    begin.reserve(automaton.states.size() + 1);
    begin.push_back(0);
    for (const auto& of_state : automaton.states) {
      edges.insert(edges.end(), of_state.begin(), of_state.end());
      begin.push_back(edges.size());
    }
  }

  std::vector<std::size_t> begin;
  std::vector<Edge> edges;

  std::size_t states() const { return begin.size() - 1; }
};

}  // namespace language
}  // namespace hyselam_topo

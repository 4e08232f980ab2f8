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

/// No cycle consumes nothing.
struct Automaton {
  std::vector<std::vector<Edge>> states;  ///< the first is the beginning
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

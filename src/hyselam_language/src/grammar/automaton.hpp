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
  /// Words one of which must come somewhere; empty if names and numbers alone may fit. Sorted, as
  /// are the first words.
  std::vector<int> needed_words;
};

}  // namespace language
}  // namespace hyselam_topo

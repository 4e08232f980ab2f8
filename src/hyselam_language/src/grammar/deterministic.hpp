// An automaton of which no state has two edges that read the same.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "automaton.hpp"

namespace hyselam_topo {
namespace language {

/// Kind and values of an edge, sorted as the edges shall be: words first.
using Label = std::uint64_t;

/// Each state's edges, sorted by label: those of state s are [begin[s], begin[s + 1]).
struct Deterministic {
  struct Way {
    Label label = 0;
    int to = 0;
  };
  std::vector<std::size_t> begin{0};
  std::vector<Way> ways;
  std::vector<bool> accepts;  ///< of each state

  std::size_t states() const { return accepts.size(); }
};

/// The edge that a label stands for.
Edge edgeOf(Label label, int to);

/// The subset construction; nothing if it has more than `max_states` states.
std::optional<Deterministic> deterministic(const EdgeTable& edges, int accept,
                                           std::size_t max_states);

}  // namespace language
}  // namespace hyselam_topo

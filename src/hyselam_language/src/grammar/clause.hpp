// A part of a sentence that a pattern fits to.
#pragma once

#include <algorithm>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// Of the tokens [begin, end).
struct Clause {
  const IntentInfo* intent = nullptr;
  const Automaton* pattern = nullptr;  ///< of the intent
  std::size_t begin = 0;
  std::size_t end = 0;
  int cost = 0;
  bool correction = false;
  bool only_corrects = false;  ///< has no meaning if it does not correct anything
  bool tied = false;           ///< where one name ends and the next begins cannot be told
  std::vector<Slot> slots;
  std::vector<Spelling> spelling;

  /// Whatever kind of name the patterns asked for: "the gym" is the gym.
  bool meansTheSameAs(const Clause& other) const {
    const auto same = [](const Slot& a, Slot b) {
      if (!a.names.empty() && !b.names.empty()) b.type = a.type;
      return a == b;
    };
    return intent == other.intent && correction == other.correction &&
           std::equal(slots.begin(), slots.end(), other.slots.begin(), other.slots.end(), same);
  }
};

}  // namespace language
}  // namespace hyselam_topo

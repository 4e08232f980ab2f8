// Words that patterns cannot do without, against all ways through small automata (the oracle).
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "grammar/word_cuts.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Whether the end can be reached without words that are blocked; those of lists always pass.
bool passes(const Automaton& automaton, const std::vector<bool>& in_list,
            const std::set<int>& blocked) {
  std::set<int> met{0};
  for (bool changes = true; changes;) {
    changes = false;
    for (const int state : std::set<int>(met)) {
      const auto s = static_cast<std::size_t>(state);
      for (const Edge& e : automaton.states[s]) {
        const bool stops = e.kind == EdgeKind::kWord && !in_list[s] && blocked.count(e.a) != 0;
        if (!stops) changes = met.insert(e.to).second || changes;
      }
    }
  }
  return met.count(automaton.accept) != 0;
}

std::set<int> setOf(const std::vector<int>& words) {
  return {words.begin(), words.end()};
}

TEST(WordCuts, KeepWhatNoWayCanDoWithout) {
  constexpr int kWords = 8;
  std::mt19937 random(7);
  const auto pick = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  int cut = 0;
  for (int round = 0; round < 500; ++round) {
    Automaton automaton;
    const int states = 3 + pick(8);
    automaton.states.resize(static_cast<std::size_t>(states));
    automaton.accept = states - 1;
    std::vector<bool> in_list(static_cast<std::size_t>(states));
    for (std::size_t state = 0; state < in_list.size(); ++state) in_list[state] = pick(6) == 0;
    for (int edges = 2 * states; edges > 0; --edges) {
      Edge edge{pick(4) > 0 ? EdgeKind::kWord : EdgeKind::kName, pick(states), pick(kWords), 0};
      automaton.states[static_cast<std::size_t>(pick(states))].push_back(edge);
    }
    WordCuts cuts(automaton, in_list, kWords);
    std::set<int> expected = setOf(cuts.words());
    ASSERT_EQ(cuts.block(), !passes(automaton, in_list, expected)) << "round " << round;
    if (!cuts.block()) continue;
    ++cut;
    std::vector<int> order(kWords);
    for (int word = 0; word < kWords; ++word) order[static_cast<std::size_t>(word)] = word;
    std::shuffle(order.begin(), order.end(), random);
    // One after the other, whatever can be done without.
    for (const int word : order) {
      if (expected.erase(word) != 0 && passes(automaton, in_list, expected)) expected.insert(word);
    }
    cuts.drop(order);
    EXPECT_EQ(setOf(cuts.blocked()), expected) << "round " << round;
  }
  EXPECT_GT(cut, 50);
}

}  // namespace
}  // namespace language
}  // namespace hyselam_topo

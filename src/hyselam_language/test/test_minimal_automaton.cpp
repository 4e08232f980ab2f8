// The minimal automaton reads what the one that patterns are written as reads (its oracle).
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "grammar/minimal_automaton.hpp"

namespace hyselam_topo {
namespace language {
namespace {

using Step = std::tuple<EdgeKind, int, int>;
using Reading = std::vector<Step>;

/// All readings of at most `length` steps that end in the accepting state.
void readings(const Automaton& automaton, int state, std::size_t length, Reading* so_far,
              std::set<int>* skipped, std::set<Reading>* all) {
  if (state == automaton.accept) all->insert(*so_far);
  for (const Edge& e : automaton.states[static_cast<std::size_t>(state)]) {
    if (e.kind == EdgeKind::kSkip) {
      if (!skipped->insert(e.to).second) continue;
      readings(automaton, e.to, length, so_far, skipped, all);
      skipped->erase(e.to);
    } else if (so_far->size() < length) {
      so_far->emplace_back(e.kind, e.a, e.b);
      std::set<int> none;
      readings(automaton, e.to, length, so_far, &none, all);
      so_far->pop_back();
    }
  }
}

std::set<Reading> readingsOf(const Automaton& automaton) {
  constexpr std::size_t kLength = 5;
  std::set<Reading> all;
  Reading so_far;
  std::set<int> skipped;
  readings(automaton, 0, kLength, &so_far, &skipped, &all);
  return all;
}

TEST(MinimalAutomaton, ReadsTheSame) {
  std::mt19937 random(5);
  const auto pick = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  std::size_t read = 0;
  for (int round = 0; round < 300; ++round) {
    Automaton automaton;
    const int states = 2 + pick(8);
    automaton.states.resize(static_cast<std::size_t>(states));
    automaton.accept = states - 1;
    for (int edges = 2 * states; edges > 0; --edges) {
      const std::vector<Edge> kinds{{EdgeKind::kSkip, 0, -1, -1},
                                    {EdgeKind::kWord, 0, pick(3), -1},
                                    {EdgeKind::kName, 0, 0, pick(2)},
                                    {EdgeKind::kValue, 0, 0, pick(2)}};
      Edge edge = kinds[static_cast<std::size_t>(pick(4))];
      edge.to = pick(states);
      automaton.states[static_cast<std::size_t>(pick(states))].push_back(edge);
    }
    const Automaton small = minimal(automaton, 1000);
    EXPECT_EQ(readingsOf(small), readingsOf(automaton)) << "round " << round;
    read += readingsOf(automaton).size();
    for (const auto& edges : small.states) {
      std::set<Step> labels;
      for (const Edge& e : edges) EXPECT_TRUE(labels.emplace(e.kind, e.a, e.b).second);
    }
    // Too small a limit: the same automaton, sorted.
    EXPECT_EQ(readingsOf(minimal(automaton, 0)), readingsOf(automaton));
  }
  EXPECT_GT(read, 1000u);
}

}  // namespace
}  // namespace language
}  // namespace hyselam_topo

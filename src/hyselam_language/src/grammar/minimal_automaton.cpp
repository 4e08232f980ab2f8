#include "minimal_automaton.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace hyselam_topo {
namespace language {
namespace {

using Label = std::tuple<EdgeKind, int, int>;
using States = std::vector<int>;  ///< sorted

/// Each state's edges by label, and whether it accepts.
struct Deterministic {
  std::vector<std::map<Label, int>> edges;
  std::vector<bool> accepts;
};

States closureOf(const Automaton& automaton, States states) {
  std::set<int> all(states.begin(), states.end());
  while (!states.empty()) {
    const int state = states.back();
    states.pop_back();
    for (const Edge& e : automaton.states[static_cast<std::size_t>(state)]) {
      if (e.kind == EdgeKind::kSkip && all.insert(e.to).second) states.push_back(e.to);
    }
  }
  return {all.begin(), all.end()};
}

/// Subset construction.
std::optional<Deterministic> determinize(const Automaton& automaton, std::size_t max_states) {
  Deterministic result;
  std::map<States, int> numbers;
  std::vector<States> sets;
  const auto numberOf = [&](const States& set) {
    const auto [at, is_new] = numbers.emplace(set, static_cast<int>(sets.size()));
    if (is_new) sets.push_back(set);
    return at->second;
  };
  numberOf(closureOf(automaton, {0}));
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (sets.size() > max_states) return std::nullopt;
    std::map<Label, States> targets;
    const States set = sets[i];
    for (const int state : set) {
      for (const Edge& e : automaton.states[static_cast<std::size_t>(state)]) {
        if (e.kind != EdgeKind::kSkip) targets[{e.kind, e.a, e.b}].push_back(e.to);
      }
    }
    result.edges.emplace_back();
    result.accepts.push_back(std::binary_search(set.begin(), set.end(), automaton.accept));
    for (const auto& [label, to] : targets) {
      result.edges.back()[label] = numberOf(closureOf(automaton, to));
    }
  }
  return result;
}

/// The class of each state: those of one class read the same.
std::vector<int> classesOf(const Deterministic& d) {
  std::vector<int> classes(d.accepts.begin(), d.accepts.end());
  std::size_t count = 0;
  while (true) {
    std::map<std::pair<int, std::map<Label, int>>, int> numbers;
    std::vector<int> refined;
    refined.reserve(classes.size());
    for (std::size_t i = 0; i < classes.size(); ++i) {
      std::map<Label, int> edges;
      for (const auto& [label, to] : d.edges[i])
        edges[label] = classes[static_cast<std::size_t>(to)];
      refined.push_back(
          numbers.emplace(std::make_pair(classes[i], edges), static_cast<int>(numbers.size()))
              .first->second);
    }
    classes = std::move(refined);
    if (numbers.size() == count) return classes;
    count = numbers.size();
  }
}

void sortEdges(Automaton* automaton) {
  for (auto& edges : automaton->states) {
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      const bool a_word = a.kind == EdgeKind::kWord, b_word = b.kind == EdgeKind::kWord;
      return a_word != b_word ? a_word : a_word && a.a < b.a;
    });
  }
}

}  // namespace

Automaton minimal(const Automaton& automaton, std::size_t max_states) {
  const auto d = determinize(automaton, max_states);
  Automaton result = automaton;
  if (d) {
    const std::vector<int> classes = classesOf(*d);
    const int count = *std::max_element(classes.begin(), classes.end()) + 1;
    // The class of the first state is number 0: it was met first.
    result.states.assign(static_cast<std::size_t>(count) + 1, {});
    result.accept = count;
    std::vector<bool> done(static_cast<std::size_t>(count), false);
    for (std::size_t i = 0; i < classes.size(); ++i) {
      const auto state = static_cast<std::size_t>(classes[i]);
      if (done[state]) continue;
      done[state] = true;
      for (const auto& [label, to] : d->edges[i]) {
        const auto& [kind, a, b] = label;
        result.states[state].push_back({kind, classes[static_cast<std::size_t>(to)], a, b});
      }
      if (d->accepts[i]) result.states[state].push_back({EdgeKind::kSkip, count, -1, -1});
    }
  }
  sortEdges(&result);
  return result;
}

}  // namespace language
}  // namespace hyselam_topo

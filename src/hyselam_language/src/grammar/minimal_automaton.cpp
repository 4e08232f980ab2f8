#include "minimal_automaton.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace hyselam_topo {
namespace language {
namespace {

/// Kind and values of an edge, sorted as the edges shall be: words first.
using Label = std::uint64_t;
using States = std::vector<int>;  ///< sorted

constexpr int kValueBits = 28;

Label labelOf(const Edge& edge) {
  const Label kind = edge.kind == EdgeKind::kWord ? 0 : static_cast<Label>(edge.kind) + 1;
  return kind << (2 * kValueBits) | static_cast<Label>(edge.a + 1) << kValueBits |
         static_cast<Label>(edge.b + 1);
}

struct HashOfNumbers {
  template <typename Number>
  std::size_t operator()(const std::vector<Number>& numbers) const {
    std::uint64_t hash = numbers.size();
    for (const Number number : numbers) {
      hash ^=
          static_cast<std::uint64_t>(number) + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2);
    }
    return static_cast<std::size_t>(hash);
  }
};

/// Each state's edges, sorted by label, and whether it accepts.
struct Deterministic {
  std::vector<std::vector<std::pair<Label, Edge>>> edges;
  std::vector<bool> accepts;
};

/// Subset construction. Sets hold only the states that accept or consume something.
class Determinization {
 public:
  Determinization(const Automaton& automaton, std::size_t max_states)
      : automaton_(automaton), max_states_(max_states), seen_(automaton.states.size(), 0) {}

  std::optional<Deterministic> run() {
    Deterministic result;
    numberOf(closureOf({0}));
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      if (sets_.size() > max_states_) return std::nullopt;
      addState(States(sets_[i]), &result);
    }
    return result;
  }

 private:
  void addState(const States& set, Deterministic* result) {
    std::vector<std::pair<Label, Edge>> all;
    for (const int state : set) {
      for (const Edge& e : automaton_.states[static_cast<std::size_t>(state)]) {
        if (e.kind != EdgeKind::kSkip) all.emplace_back(labelOf(e), e);
      }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    result->accepts.push_back(std::binary_search(set.begin(), set.end(), automaton_.accept));
    result->edges.emplace_back();
    for (auto from = all.begin(); from != all.end();) {
      States targets;
      auto to = from;
      for (; to != all.end() && to->first == from->first; ++to) targets.push_back(to->second.to);
      Edge edge = from->second;
      edge.to = numberOf(closureOf(std::move(targets)));
      result->edges.back().emplace_back(from->first, edge);
      from = to;
    }
  }

  int numberOf(States set) {
    const auto [at, is_new] = numbers_.emplace(set, static_cast<int>(sets_.size()));
    if (is_new) sets_.push_back(std::move(set));
    return at->second;
  }

  States closureOf(States open) {
    ++round_;
    States all;
    for (const int state : open) seen_[static_cast<std::size_t>(state)] = round_;
    while (!open.empty()) {
      const int state = open.back();
      open.pop_back();
      bool consumes = state == automaton_.accept;
      for (const Edge& e : automaton_.states[static_cast<std::size_t>(state)]) {
        if (e.kind != EdgeKind::kSkip) {
          consumes = true;
        } else if (seen_[static_cast<std::size_t>(e.to)] != round_) {
          seen_[static_cast<std::size_t>(e.to)] = round_;
          open.push_back(e.to);
        }
      }
      if (consumes) all.push_back(state);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  const Automaton& automaton_;
  const std::size_t max_states_;
  std::vector<int> seen_;  ///< the round in which a state was met last
  int round_ = 0;
  std::unordered_map<States, int, HashOfNumbers> numbers_;
  std::vector<States> sets_;
};

/// The class of each state: those of one class read the same.
std::vector<int> classesOf(const Deterministic& d) {
  std::vector<int> classes(d.accepts.begin(), d.accepts.end());
  std::vector<Label> reading;
  for (std::size_t count = 0;;) {
    std::unordered_map<std::vector<Label>, int, HashOfNumbers> numbers;
    std::vector<int> refined;
    refined.reserve(classes.size());
    for (std::size_t i = 0; i < classes.size(); ++i) {
      reading.assign(1, static_cast<Label>(classes[i]));
      for (const auto& [label, edge] : d.edges[i]) {
        reading.push_back(label);
        reading.push_back(static_cast<Label>(classes[static_cast<std::size_t>(edge.to)]));
      }
      refined.push_back(numbers.emplace(reading, static_cast<int>(numbers.size())).first->second);
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
  const auto d = Determinization(automaton, max_states).run();
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
      for (const auto& [label, edge] : d->edges[i]) {
        result.states[state].push_back(edge);
        result.states[state].back().to = classes[static_cast<std::size_t>(edge.to)];
      }
      if (d->accepts[i]) result.states[state].push_back({EdgeKind::kSkip, count, -1, -1});
    }
  }
  sortEdges(&result);
  return result;
}

}  // namespace language
}  // namespace hyselam_topo

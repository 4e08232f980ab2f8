#include "minimal_automaton.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "deterministic.hpp"
#include "row_numbers.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// The class of each state: those of one class read the same. States of lists, which lead back to
/// themselves, are refined until nothing changes; all others are told by what they lead to.
class Classes {
 public:
  explicit Classes(const Deterministic& d) : d_(d), classes_(d.states(), -1), kinds_(d.states()) {}

  std::vector<int> find() {
    orderStates();
    findLoops();
    for (const int state : order_) {
      if (!kinds_[at(state)].leads_to_loop) number(state);
    }
    refineLoops();
    for (const int state : order_) {
      if (classes_[at(state)] < 0) number(state);
    }
    return classes_;
  }

 private:
  struct Kind {
    bool loops = false;
    bool leads_to_loop = false;
    bool comes_from_loop = false;
  };

  static std::size_t at(int number) { return static_cast<std::size_t>(number); }

  /// Each state behind all that it leads to, as far as there are no loops: a depth-first walk.
  void orderStates() {
    place_.assign(d_.states(), -1);
    std::vector<std::pair<int, std::size_t>> open;
    std::vector<bool> met(d_.states(), false);
    met[0] = true;
    open.emplace_back(0, d_.begin[0]);
    while (!open.empty()) {
      auto& [state, way] = open.back();
      if (way == d_.begin[at(state) + 1]) {
        place_[at(state)] = static_cast<int>(order_.size());
        order_.push_back(state);
        open.pop_back();
        continue;
      }
      const int to = d_.ways[way++].to;
      if (met[at(to)]) continue;
      met[at(to)] = true;
      open.emplace_back(to, d_.begin[at(to)]);
    }
  }

  template <typename F>
  void eachWay(int state, F&& f) const {
    for (std::size_t w = d_.begin[at(state)]; w < d_.begin[at(state) + 1]; ++w) f(d_.ways[w]);
  }

  /// A way to a state that does not come before in the order leads back: whatever lies between
  /// its ends may be on a loop.
  void findLoops() {
    for (bool changes = true; changes;) {
      changes = false;
      for (const int state : order_) {
        Kind& kind = kinds_[at(state)];
        const bool before = kind.leads_to_loop;
        eachWay(state, [&](const Deterministic::Way& way) {
          const bool back = place_[at(way.to)] >= place_[at(state)];
          kind.leads_to_loop = kind.leads_to_loop || back || kinds_[at(way.to)].leads_to_loop;
          if (back) kinds_[at(way.to)].loops = true;
        });
        changes = changes || kind.leads_to_loop != before;
      }
    }
    for (bool changes = true; changes;) {
      changes = false;
      for (auto state = order_.rbegin(); state != order_.rend(); ++state) {
        const Kind kind = kinds_[at(*state)];
        if (!kind.loops && !kind.comes_from_loop) continue;
        eachWay(*state, [&](const Deterministic::Way& way) {
          bool& comes = kinds_[at(way.to)].comes_from_loop;
          changes = changes || !comes;
          comes = true;
        });
      }
    }
  }

  /// What is read from a state on, by the classes of what it leads to.
  void read(int state, const std::vector<int>& classes) {
    row_.assign(1, d_.accepts[at(state)] ? 1 : 0);
    eachWay(state, [&](const Deterministic::Way& way) {
      row_.push_back(way.label);
      row_.push_back(static_cast<Label>(classes[at(way.to)] + 1));
    });
  }

  void number(int state) {
    read(state, classes_);
    classes_[at(state)] = rows_.of(row_).first;
  }

  /// Moore's refinement of the states between loops; those behind them have their classes.
  void refineLoops() {
    std::vector<int> loops;
    for (const int state : order_) {
      const Kind& kind = kinds_[at(state)];
      if (kind.leads_to_loop && (kind.loops || kind.comes_from_loop)) loops.push_back(state);
    }
    if (loops.empty()) return;
    const int first = static_cast<int>(rows_.size());
    std::vector<int> classes = classes_;
    for (const int state : loops) classes[at(state)] = first;
    for (std::size_t count = 0;;) {
      RowNumbers<Label> rows;
      std::vector<int> refined = classes;
      for (const int state : loops) {
        read(state, classes);
        row_.push_back(static_cast<Label>(classes[at(state)]));
        refined[at(state)] = first + rows.of(row_).first;
      }
      classes = std::move(refined);
      if (rows.size() == count) break;
      count = rows.size();
    }
    // Others that read the same get the same numbers.
    for (const int state : loops) {
      if (classes[at(state)] != static_cast<int>(rows_.size())) continue;
      read(state, classes);
      rows_.of(row_);
    }
    for (const int state : loops) classes_[at(state)] = classes[at(state)];
  }

  const Deterministic& d_;
  std::vector<int> classes_;  ///< -1: not known yet
  std::vector<Kind> kinds_;
  std::vector<int> order_, place_;
  RowNumbers<Label> rows_;
  std::vector<Label> row_;
};

void sortEdges(Automaton* automaton) {
  for (auto& edges : automaton->states) {
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      const bool a_word = a.kind == EdgeKind::kWord, b_word = b.kind == EdgeKind::kWord;
      return a_word != b_word ? a_word : a_word && a.a < b.a;
    });
  }
}

/// One state of each class, the first first, and an accepting state behind them.
void merge(const Deterministic& d, const std::vector<int>& classes, Automaton* result) {
  std::vector<int> numbers(
      static_cast<std::size_t>(*std::max_element(classes.begin(), classes.end()) + 1), -1);
  int count = 0;
  for (const int each : classes) {
    int& number = numbers[static_cast<std::size_t>(each)];
    if (number < 0) number = count++;
  }
  result->states.resize(static_cast<std::size_t>(count) + 1);
  result->accept = count;
  for (std::size_t i = 0, next = 0; i < classes.size(); ++i) {
    if (numbers[static_cast<std::size_t>(classes[i])] != static_cast<int>(next)) continue;
    auto& edges = result->states[next++];
    edges.reserve(d.begin[i + 1] - d.begin[i] + (d.accepts[i] ? 1 : 0));
    for (std::size_t w = d.begin[i]; w < d.begin[i + 1]; ++w) {
      const int to = classes[static_cast<std::size_t>(d.ways[w].to)];
      edges.push_back(edgeOf(d.ways[w].label, numbers[static_cast<std::size_t>(to)]));
    }
    if (d.accepts[i]) edges.push_back({EdgeKind::kSkip, count, -1, -1});
  }
}

}  // namespace

Automaton minimal(const Automaton& automaton, std::size_t max_states) {
  const auto d = deterministic(EdgeTable(automaton), automaton.accept, max_states);
  if (!d) {
    Automaton result = automaton;
    sortEdges(&result);
    return result;
  }
  Automaton result;
  result.slots = automaton.slots;
  result.telling_words = automaton.telling_words;
  result.first_words = automaton.first_words;
  result.needed_words = automaton.needed_words;
  merge(*d, Classes(*d).find(), &result);
  return result;
}

}  // namespace language
}  // namespace hyselam_topo

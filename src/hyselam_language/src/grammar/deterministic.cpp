#include "deterministic.hpp"

#include <algorithm>
#include <utility>

#include "row_numbers.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr int kValueBits = 28;
constexpr Label kValueMask = (Label{1} << kValueBits) - 1;

Label labelOf(const Edge& edge) {
  const Label kind = edge.kind == EdgeKind::kWord ? 0 : static_cast<Label>(edge.kind) + 1;
  return kind << (2 * kValueBits) | static_cast<Label>(edge.a + 1) << kValueBits |
         static_cast<Label>(edge.b + 1);
}

/// Subset construction. Sets hold only the states that accept or consume something.
class Determinization {
 public:
  Determinization(const EdgeTable& table, int accept, std::size_t max_states)
      : table_(table),
        accept_(accept),
        max_states_(max_states),
        seen_(table.states(), 0),
        alone_(table.states(), -1) {}

  std::optional<Deterministic> run() {
    Deterministic result;
    afterState(0);
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      if (sets_.size() > max_states_) return std::nullopt;
      addState(static_cast<int>(i), &result);
    }
    return result;
  }

 private:
  using Way = Deterministic::Way;

  void addState(int set, Deterministic* result) {
    all_.clear();
    for (const int* state = sets_.begin(set); state != sets_.end(set); ++state) {
      const auto s = static_cast<std::size_t>(*state);
      for (std::size_t e = table_.begin[s]; e < table_.begin[s + 1]; ++e) {
        const Edge& edge = table_.edges[e];
        if (edge.kind != EdgeKind::kSkip) all_.push_back({labelOf(edge), edge.to});
      }
    }
    std::sort(all_.begin(), all_.end(), [](const Way& a, const Way& b) {
      return a.label != b.label ? a.label < b.label : a.to < b.to;
    });
    result->accepts.push_back(std::binary_search(sets_.begin(set), sets_.end(set), accept_));
    for (std::size_t from = 0; from < all_.size();) {
      std::size_t to = from + 1;
      while (to < all_.size() && all_[to].label == all_[from].label) ++to;
      result->ways.push_back({all_[from].label, after(from, to)});
      from = to;
    }
    result->begin.push_back(result->ways.size());
  }

  /// The set behind ways that read the same.
  int after(std::size_t from, std::size_t to) {
    if (all_[from].to == all_[to - 1].to) return afterState(all_[from].to);
    startClosure();
    for (std::size_t i = from; i < to; ++i) open(all_[i].to);
    return closure();
  }

  int afterState(int state) {
    int& known = alone_[static_cast<std::size_t>(state)];
    if (known < 0) {
      startClosure();
      open(state);
      known = closure();
    }
    return known;
  }

  void startClosure() {
    ++round_;
    open_.clear();
  }

  void open(int state) {
    int& seen = seen_[static_cast<std::size_t>(state)];
    if (seen == round_) return;
    seen = round_;
    open_.push_back(state);
  }

  /// The number of the set of all that the open states come to by nothing.
  int closure() {
    set_.clear();
    while (!open_.empty()) {
      const int state = open_.back();
      open_.pop_back();
      bool consumes = state == accept_;
      const auto s = static_cast<std::size_t>(state);
      for (std::size_t e = table_.begin[s]; e < table_.begin[s + 1]; ++e) {
        const Edge& edge = table_.edges[e];
        if (edge.kind == EdgeKind::kSkip) {
          open(edge.to);
        } else {
          consumes = true;
        }
      }
      if (consumes) set_.push_back(state);
    }
    std::sort(set_.begin(), set_.end());
    return sets_.of(set_).first;
  }

  const EdgeTable& table_;
  const int accept_;
  const std::size_t max_states_;
  std::vector<int> seen_;  ///< the round in which a state was met last
  int round_ = 0;
  std::vector<int> alone_;  ///< the set behind each single state; -1: not known yet
  std::vector<int> open_, set_;
  std::vector<Way> all_;
  RowNumbers<int> sets_;
};

}  // namespace

Edge edgeOf(Label label, int to) {
  const Label kind = label >> (2 * kValueBits);
  Edge edge;
  edge.kind = kind == 0 ? EdgeKind::kWord : static_cast<EdgeKind>(kind - 1);
  edge.to = to;
  edge.a = static_cast<int>((label >> kValueBits) & kValueMask) - 1;
  edge.b = static_cast<int>(label & kValueMask) - 1;
  return edge;
}

std::optional<Deterministic> deterministic(const EdgeTable& edges, int accept,
                                           std::size_t max_states) {
  return Determinization(edges, accept, max_states).run();
}

}  // namespace language
}  // namespace hyselam_topo

#include "automaton.hpp"

namespace hyselam_topo {
namespace language {

PackedStates::PackedStates(const std::vector<std::vector<Edge>>& states) {
  std::size_t words = 0, others = 0;
  for (const auto& edges : states) {
    for (const Edge& edge : edges) ++(edge.kind == EdgeKind::kWord ? words : others);
  }
  begins_.reserve(states.size() + 1);
  words_.reserve(words);
  others_.reserve(others);
  const auto begin = [&] {
    begins_.push_back(
        {static_cast<std::uint32_t>(words_.size()), static_cast<std::uint32_t>(others_.size())});
  };
  for (const auto& edges : states) {
    begin();
    for (const Edge& edge : edges) {
      if (edge.kind == EdgeKind::kWord) {
        words_.push_back({edge.a, edge.to});
      } else {
        others_.push_back(edge);
      }
    }
  }
  begin();
}

}  // namespace language
}  // namespace hyselam_topo

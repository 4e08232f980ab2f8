#include "search_state.hpp"

#include "name_tables.hpp"

namespace hyselam_topo::merging {

SearchState::SearchState(const MatchProblem& problem)
    : problem_(problem),
      vertices_(problem.nameCount()),
      is_closed_(problem.nameCount(), 0),
      closed_neighbors_(problem.nameCount(), 0),
      assignment_(problem.vertexCount(), -1) {
  for (std::size_t v = 0; v < problem.vertexCount(); ++v) free_.insert(v);
}

void SearchState::close(int name, const VertexSet& vertices, double loss) {
  loss_ += loss;
  vertices_[at(name)] = vertices;
  is_closed_[at(name)] = 1;
  closed_.push_back(name);
  free_ -= vertices.members;
  named_vertices_ += at(vertices.count);
  vertices.members.forEach([&](std::size_t v) { assignment_[v] = name; });
  for (std::size_t i = 0; i < closed_neighbors_.size(); ++i)
    closed_neighbors_[i] += problem_.areConnected(i, at(name));
}

void SearchState::reopen(double loss_before) {
  const int name = closed_.back();
  const VertexSet& vertices = vertices_[at(name)];
  for (std::size_t i = 0; i < closed_neighbors_.size(); ++i)
    closed_neighbors_[i] -= problem_.areConnected(i, at(name));
  vertices.members.forEach([&](std::size_t v) { assignment_[v] = -1; });
  named_vertices_ -= at(vertices.count);
  free_ |= vertices.members;
  closed_.pop_back();
  is_closed_[at(name)] = 0;
  loss_ = loss_before;
}

}  // namespace hyselam_topo::merging

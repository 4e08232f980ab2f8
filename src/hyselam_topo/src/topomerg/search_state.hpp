// The partial assignment of the exact search: which names have got their final vertices.
#pragma once

#include <vector>

#include "fitness_terms.hpp"
#include "hyselam_topo/topomerg/fitness.hpp"

namespace hyselam_topo::merging {

class SearchState {
 public:
  explicit SearchState(const MatchProblem& problem);

  /// Gives a name its final vertices; `loss`: what it loses with them and the names before it.
  void close(int name, const VertexSet& vertices, double loss);
  /// Takes the vertices of the last name back; `loss_before`: loss() before it.
  void reopen(double loss_before);

  bool isClosed(int name) const { return is_closed_[static_cast<std::size_t>(name)] != 0; }
  /// Of a closed name.
  const VertexSet& vertices(int name) const { return vertices_[static_cast<std::size_t>(name)]; }
  /// Closed names in the order in which they were closed.
  const std::vector<int>& closed() const { return closed_; }
  /// As many closed names are described as connected to this one.
  int closedNeighbors(int name) const { return closed_neighbors_[static_cast<std::size_t>(name)]; }
  /// Vertices without a name.
  const PlaceSet& free() const { return free_; }
  const Assignment& assignment() const { return assignment_; }
  std::size_t namedVertices() const { return named_vertices_; }
  /// Loss of the closed names.
  double loss() const { return loss_; }

 private:
  const MatchProblem& problem_;
  std::vector<VertexSet> vertices_;
  std::vector<char> is_closed_;
  std::vector<int> closed_;
  std::vector<int> closed_neighbors_;
  PlaceSet free_;
  Assignment assignment_;
  std::size_t named_vertices_ = 0;
  double loss_ = 0.0;
};

}  // namespace hyselam_topo::merging

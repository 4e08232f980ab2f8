// What the exact search knows of the names and stays the same all the time: their described edges
// and sides, what a missing edge costs, which names and vertices are confirmed.
#pragma once

#include <cstddef>
#include <vector>

#include "fitness_terms.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo::merging {

inline std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

class NameTables {
 public:
  NameTables(const MatchProblem& problem, const FitnessTerms& terms);

  int nameCount() const { return n_; }
  /// Described edges of a name.
  int degree(int name) const { return degree_[at(name)]; }
  /// Whether some vertex is confirmed to have this name.
  bool isConfirmed(int name) const { return is_confirmed_[at(name)] != 0; }
  const PlaceSet& confirmedVertices() const { return confirmed_vertices_; }
  /// Vertices with many neighbors in the map.
  const PlaceSet& hubVertices() const { return hub_vertices_; }
  /// Number in problem.sides of the side described of two names, -1: none.
  int sideBetween(int i, int j) const { return side_between_[at(i * n_ + j)]; }
  /// Loss of two names that are described as connected and are not in the map.
  double missingEdgeLoss(int i, int j) const { return missing_edge_loss_[at(i * n_ + j)]; }
  /// The least of it if they share a wall.
  double sharedWallLoss(int i, int j) const { return shared_wall_loss_[at(i * n_ + j)]; }
  /// Loss of two names that are described as connected, if one has no vertices.
  double absentLoss(int i, int j) const { return absent_loss_[at(i * n_ + j)]; }
  /// Of two names without vertices yet one bears the loss of their missing edge, so that it is not
  /// counted twice: the names whose edges to this one are borne by this one.
  const std::vector<int>& borneEdgesOf(int name) const { return borne_edges_[at(name)]; }
  /// Sides are described in few directions (left, right, ...): the number of that of a side.
  int directionOf(int side) const { return direction_of_[at(side)]; }
  std::size_t directionCount() const { return direction_count_; }

 private:
  /// Whether `i` comes before `j`: by its degree, then by its number.
  bool precedes(int i, int j) const;

  int n_;
  std::vector<int> degree_;
  std::vector<char> is_confirmed_;
  PlaceSet confirmed_vertices_;
  PlaceSet hub_vertices_;
  std::vector<int> side_between_;
  std::vector<double> missing_edge_loss_, shared_wall_loss_, absent_loss_;
  std::vector<std::vector<int>> borne_edges_;
  std::vector<int> direction_of_;
  std::size_t direction_count_ = 0;
};

}  // namespace hyselam_topo::merging

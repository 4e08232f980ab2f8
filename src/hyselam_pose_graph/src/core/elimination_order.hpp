// In which order the variables of a sparse symmetric system are eliminated.
#pragma once

#include <utility>
#include <vector>

namespace hyselam_pose_graph {

/// Compressed neighbor lists of a symmetric pattern, without the diagonal and without duplicates.
struct Adjacency {
  std::vector<int> begin, neighbor;

  int size() const { return static_cast<int>(begin.size()) - 1; }
};

/// @throws hyselam::InputError for variables out of range and couplings of one with itself.
Adjacency adjacencyOf(int variables, const std::vector<std::pair<int, int>>& couplings);

/// The variables in an order of little fill. Those with one or two neighbors go first, again and
/// again: most poses of a graph follow one another without a loop, and to take such a pose out
/// couples its two neighbors, whatever the rest looks like. The rest is ordered by approximate
/// minimum degree (AMD of SuiteSparse).
std::vector<int> eliminationOrder(const Adjacency& adjacency);

}  // namespace hyselam_pose_graph

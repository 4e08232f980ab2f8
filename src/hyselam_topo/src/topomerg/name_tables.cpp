#include "name_tables.hpp"

#include <algorithm>

namespace hyselam_topo::merging {
namespace {

/// Whoever takes a vertex with as many neighbors is in the way of names of a high degree.
constexpr std::size_t kHubDegree = 3;

}  // namespace

NameTables::NameTables(const MatchProblem& problem, const FitnessTerms& terms)
    : n_(static_cast<int>(problem.nameCount())),
      degree_(problem.nameCount(), 0),
      is_confirmed_(problem.nameCount(), 0),
      side_between_(problem.nameCount() * problem.nameCount(), -1),
      missing_edge_loss_(side_between_.size(), 0.0),
      shared_wall_loss_(side_between_.size(), 0.0),
      absent_loss_(side_between_.size(), 0.0),
      borne_edges_(problem.nameCount()) {
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) degree_[at(i)] += problem.areConnected(at(i), at(j));
  for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
    if (problem.neighbors[v].size() >= kHubDegree) hub_vertices_.insert(v);
    if (problem.confirmed_name[v] < 0) continue;
    confirmed_vertices_.insert(v);
    is_confirmed_[at(problem.confirmed_name[v])] = 1;
  }
  std::vector<double> directions;
  for (std::size_t s = 0; s < problem.sides.size(); ++s) {
    const MatchProblem::DescribedSide& side = problem.sides[s];
    side_between_[at(side.from * n_ + side.to)] = static_cast<int>(s);
    side_between_[at(side.to * n_ + side.from)] = static_cast<int>(s);
    const auto known = std::find(directions.begin(), directions.end(), side.side_angle);
    direction_of_.push_back(static_cast<int>(known - directions.begin()));
    if (known == directions.end()) directions.push_back(side.side_angle);
  }
  direction_count_ = directions.size();
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const int s = sideBetween(i, j);
      missing_edge_loss_[at(i * n_ + j)] =
          terms.weight(Term::kEdge) + (s >= 0 ? terms.missingSideLoss(problem.sides[at(s)]) : 0.0);
      absent_loss_[at(i * n_ + j)] = terms.absent_share * missing_edge_loss_[at(i * n_ + j)];
      shared_wall_loss_[at(i * n_ + j)] =
          terms.describedEdgeLoss(Contact::kWall) +
          (s >= 0 ? terms.throughWall(problem.sides[at(s)], 0.0) : 0.0);
      if (problem.areConnected(at(i), at(j)) && precedes(j, i)) borne_edges_[at(i)].push_back(j);
    }
  }
}

bool NameTables::precedes(int i, int j) const {
  const int a = degree(i), b = degree(j);
  return a != b ? a > b : i < j;
}

}  // namespace hyselam_topo::merging

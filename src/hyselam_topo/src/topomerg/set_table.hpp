// The sets of vertices that names may take: listed where they are few.
//
// Vertices are ranked, those with most neighbors first: sets without the few that lead to many are
// small pieces of the map. The first vertex of a set by rank is its anchor.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "fitness_terms.hpp"
#include "search_node.hpp"

namespace hyselam_topo::merging {

class SetTable {
 public:
  /// Lists the sets of `vertices`. `connected`: see SolverParams.
  SetTable(const MatchProblem& problem, bool connected, const PlaceSet& vertices);

  /// Sets that are listed once and for all.
  const std::vector<CandidateSet>& listed() const { return listed_; }
  /// Vertices ranked below this one.
  const PlaceSet& rankedBelow(int vertex) const {
    return ranked_below_[static_cast<std::size_t>(vertex)];
  }
  /// The sets of `node.available` into the node, and columns for these vertices.
  void listSets(SearchNode& node) const;

  const VertexSet& setOf(const SearchNode& node, std::size_t number) const {
    return candidate(node, number).vertices;
  }
  int anchorOf(const SearchNode& node, std::size_t number) const {
    return candidate(node, number).anchor;
  }

 private:
  const CandidateSet& candidate(const SearchNode& node, std::size_t number) const {
    return number < node.alive.size() ? listed_[static_cast<std::size_t>(node.alive[number])]
                                      : node.extra[number - node.alive.size()];
  }
  /// The anchor and the vertices of `of` ranked below it that it reaches.
  PlaceSet piece(std::size_t anchor, const PlaceSet& of) const;
  /// All sets of a piece with this anchor. False, without a visit, for more than `limit` vertices.
  bool forEachSet(std::size_t anchor, const PlaceSet& piece, std::size_t limit,
                  const std::function<void(const VertexSet&)>& visit) const;

  const MatchProblem& problem_;
  const bool connected_;
  std::vector<PlaceSet> ranked_below_;  ///< of each vertex
  std::vector<CandidateSet> listed_;
  std::vector<int> unlisted_anchors_;  ///< anchors with too many sets
};

}  // namespace hyselam_topo::merging

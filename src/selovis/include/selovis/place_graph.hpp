// Places and the doors between them: what SeLoViS needs of the augmented topological map.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace selovis {

/// The vertices and edges of Eq. 3.1, as far as the Markov chain inherits them.
struct PlaceGraph {
  std::vector<std::string> places;               ///< unique, in the order of the classes
  std::vector<std::pair<int, int>> transitions;  ///< places that one can walk between, either way

  /// -1 if there is none of that name.
  int find(const std::string& name) const;
  /// Whether a transition joins the two.
  bool connected(int a, int b) const;
};

/// A place that got another name.
struct Renaming {
  std::string from, to;
};
/// Gives places their new names. One whose new name is there already keeps the old one. Returns
/// how many have changed.
std::size_t rename(const std::vector<Renaming>& renamings, PlaceGraph* graph);

/// Shortest paths. first_step[i * n + j] is a(i, j) of Eq. 6.22: the place next to j on a shortest
/// path from j to i (the one with the lowest index among equals); distance[i * n + j] is d(i, j) of
/// Eq. 6.21, -1 where there is no path.
struct PlaceDistances {
  std::size_t size = 0;
  std::vector<int> distance, first_step;
};
PlaceDistances shortestPaths(const PlaceGraph& graph);

/// Reads a graph: JSON {"places": [...], "transitions": [["a", "b"], ...]}, or an edge list in CSV,
/// "a,b" per line ("a" alone: a place without transitions; a first line "from,to" is passed over).
/// Told by the first character that is no space: '{' is JSON. Throws hyselam::InputError.
PlaceGraph readPlaceGraph(const std::string& path);

/// Transitions between labels that follow each other in a tour.
PlaceGraph graphOfTours(const std::vector<std::string>& places,
                        const std::vector<std::vector<int>>& tours);

/// The same transitions among `places`, in their order. Places that `graph` does not have stay
/// without transitions and are added to `missing`.
PlaceGraph reordered(const PlaceGraph& graph, const std::vector<std::string>& places,
                     std::vector<std::string>* missing = nullptr);

}  // namespace selovis

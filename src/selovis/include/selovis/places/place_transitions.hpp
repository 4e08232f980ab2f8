// Connections between places: the part of the augmented topological map that SeLoViS uses.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace selovis {

/// The vertices and edges of the topological map (dos Santos 2014, Eq. 3.1) that the Markov chain
/// inherits.
struct PlaceTransitions {
  std::vector<std::string> places;  ///< unique names, in the order of the classes
  std::vector<std::pair<int, int>>
      pairs;  ///< places that are directly connected, in both directions

  /// -1 if there is no place of that name.
  int indexOf(const std::string& name) const;
  /// Whether one of the pairs joins the two places.
  bool connected(int a, int b) const;
};

/// A place that was given another name.
struct PlaceRenaming {
  std::string from, to;
};
/// Gives places their new names; a place whose new name is taken keeps the old one.
/// @returns how many names have changed.
std::size_t renamePlaces(const std::vector<PlaceRenaming>& renamings,
                         PlaceTransitions& transitions);

/// Shortest paths between places, by number of transitions.
struct PlaceDistances {
  std::size_t size = 0;
  std::vector<int> distance;  ///< [i * n + j]: d(i, j) of Eq. 6.21; -1 where there is no path
  /// [i * n + j]: a(i, j) of Eq. 6.22, the place next to j on a shortest path from j to i (that
  /// with the lowest index among equals); -1 where there is no path.
  std::vector<int> first_step;

  int distanceBetween(std::size_t i, std::size_t j) const { return distance[i * size + j]; }
};
PlaceDistances shortestPaths(const PlaceTransitions& transitions);

/// Reads JSON {"places": [...], "transitions": [["a", "b"], ...]}, or an edge list in CSV, "a,b"
/// per line ("a" alone: a place without transitions; a first line "from,to" is a header). A file
/// whose first character other than white space is '{' is JSON.
/// @throws hyselam::InputError.
PlaceTransitions readPlaceTransitions(const std::string& path);

/// Transitions between the labels that follow each other in tours.
PlaceTransitions transitionsOfTours(const std::vector<std::string>& places,
                                    const std::vector<std::vector<int>>& tours);

/// The same transitions among `places`, in that order; places that `transitions` does not have are
/// without any.
PlaceTransitions reordered(const PlaceTransitions& transitions,
                           const std::vector<std::string>& places);

/// Those of `names` that are no places of `transitions`.
std::vector<std::string> missingPlaces(const PlaceTransitions& transitions,
                                       const std::vector<std::string>& names);

}  // namespace selovis

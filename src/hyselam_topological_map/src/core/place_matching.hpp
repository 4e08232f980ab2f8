// Which place of an old map lives on in which place of a new one.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct PlaceMatching {
  /// Old places that no segmentation has found: virtual ones and those without a cell. They stay.
  std::set<Id> described;
  /// The new place (its id in the new map) in which an old one goes on.
  std::map<Id, Id> heir;
  /// New place -> the old places it goes on for, the one that gives the id first.
  std::map<Id, std::vector<Id>> ancestors;
  /// New place -> old places that share cells with it, most cells first.
  std::map<Id, std::vector<Id>> touching;
  /// New places that stand for described ones of the old map, and are passed over.
  std::set<Id> passed_over;
};

/// Both maps must have a grid.
PlaceMatching matchPlaces(const AugmentedTopologicalMap& old, const AugmentedTopologicalMap& fresh,
                          double min_overlap);

}  // namespace hyselam_topo

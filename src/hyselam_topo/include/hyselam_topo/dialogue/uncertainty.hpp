// Which names of a match are not sure.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// Answers that fit as well as the best one put these names elsewhere.
struct Uncertainty {
  std::set<std::string> names;
  /// Where each of them is in the answers that were kept, the best answer's places first.
  std::map<std::string, std::vector<Id>> places;
  /// Where a name is rather than anywhere else: of these and of those that are sure, unless
  /// answers that fit equally well put it elsewhere.
  std::map<std::string, Id> likely;
  std::size_t answers = 1;  ///< that fit equally well
  bool more = false;        ///< at least so many
};

}  // namespace hyselam_topo

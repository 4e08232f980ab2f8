// Which names of a match are not sure.
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace hyselam_topo {

/// Answers that fit as well as the best one put these names elsewhere.
struct Uncertainty {
  std::set<std::string> names;
  std::size_t answers = 1;  ///< that fit equally well
  bool more = false;        ///< at least so many
};

}  // namespace hyselam_topo

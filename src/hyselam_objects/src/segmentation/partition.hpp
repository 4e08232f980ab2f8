// Which members of a graph belong together, by odds for and against each pair.
#pragma once

#include <vector>

namespace hyselam_objects {

/// Log-odds that two members belong together.
struct PairOdds {
  int first = 0, second = 0;  ///< two different numbers of 0 .. members - 1
  double odds = 0.0;
};

/// Greedy additive edge contraction (Keuper et al., Efficient decomposition of image and mesh
/// graphs by lifted multicuts, ICCV 2015): the two groups with most evidence for being one are
/// joined, and their evidence for and against each other group is added, until no evidence for
/// joining is left. Of equal odds the pair with the smaller numbers is first. Several odds of one
/// pair add up. The smallest member of the group of each member.
std::vector<int> partitionByOdds(int members, const std::vector<PairOdds>& pairs);

}  // namespace hyselam_objects

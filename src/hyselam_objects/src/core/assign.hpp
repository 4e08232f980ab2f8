// Which of some things are which of others, at the least cost of all together.
#pragma once

#include <vector>

namespace hyselam_objects {

/// For each row the column it gets, each column at most once, -1 for none; `without` is the cost of
/// a row that goes without, costs above it are never paid. Rows of equal length. The least sum
/// (Hungarian method, by shortest augmenting paths), equal input gives equal output.
std::vector<int> assignRows(const std::vector<std::vector<double>>& cost, double without);

}  // namespace hyselam_objects

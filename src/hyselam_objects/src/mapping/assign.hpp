// Assignment problem: rows to columns at the smallest total cost.
#pragma once

#include <vector>

namespace hyselam_objects {

/// For each row its column, each column at most once, -1 for none; `unassigned_cost` is the cost of
/// a row without a column, so that no higher cost is ever chosen. Rows of equal length. The
/// smallest sum (Hungarian method, by shortest augmenting paths); equal input gives equal output.
std::vector<int> assignRows(const std::vector<std::vector<double>>& cost, double unassigned_cost);

}  // namespace hyselam_objects

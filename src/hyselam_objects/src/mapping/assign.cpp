#include "assign.hpp"

#include "hyselam_common/assignment.hpp"

namespace hyselam_objects {

std::vector<int> assignRows(const std::vector<std::vector<double>>& cost, double unassigned_cost) {
  const int rows = static_cast<int>(cost.size());
  const int columns = cost.empty() ? 0 : static_cast<int>(cost.front().size());
  hyselam::Assignment assignment;
  assignment.reset(rows, columns);
  for (int row = 0; row < rows; ++row) {
    assignment.without(row) = unassigned_cost;
    for (int column = 0; column < columns; ++column) {
      const double each = cost[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      if (each <= unassigned_cost) assignment.cost(row, column) = each;
    }
    assignment.addRow(row);
  }
  std::vector<int> assigned;
  for (int row = 0; row < rows; ++row) assigned.push_back(assignment.columnOf(row));
  return assigned;
}

}  // namespace hyselam_objects

#include "assign.hpp"

#include <algorithm>
#include <limits>

namespace hyselam_objects {

std::vector<int> assignRows(const std::vector<std::vector<double>>& cost, double without) {
  const std::size_t rows = cost.size(), real = rows > 0 ? cost.front().size() : 0;
  // A column of its own for each row that goes without; row and column 0 are the search's own.
  const std::size_t columns = real + rows;
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const double never = 1e3 * (without + 1.0) * static_cast<double>(rows + 1);
  const auto at = [&](std::size_t row, std::size_t column) {
    if (column >= real) return column - real == row ? without : never;
    return cost[row][column] > without ? never : cost[row][column];
  };
  std::vector<double> u(rows + 1, 0.0), v(columns + 1, 0.0);
  std::vector<std::size_t> row_of(columns + 1, 0), before(columns + 1, 0);
  for (std::size_t row = 1; row <= rows; ++row) {
    row_of[0] = row;
    std::size_t column = 0;
    std::vector<double> least(columns + 1, kInfinite);
    std::vector<char> used(columns + 1, 0);
    do {
      used[column] = 1;
      const std::size_t from = row_of[column];
      double step = kInfinite;
      std::size_t next = 0;
      for (std::size_t c = 1; c <= columns; ++c) {
        if (used[c] != 0) continue;
        const double reduced = at(from - 1, c - 1) - u[from] - v[c];
        if (reduced < least[c]) {
          least[c] = reduced;
          before[c] = column;
        }
        if (least[c] < step) {
          step = least[c];
          next = c;
        }
      }
      for (std::size_t c = 0; c <= columns; ++c) {
        if (used[c] != 0) {
          u[row_of[c]] += step;
          v[c] -= step;
        } else {
          least[c] -= step;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = before[column]) row_of[column] = row_of[before[column]];
  }
  std::vector<int> of(rows, -1);
  for (std::size_t c = 1; c <= real; ++c) {
    if (row_of[c] == 0) continue;
    const std::size_t row = row_of[c] - 1;
    if (cost[row][c - 1] <= without) of[row] = static_cast<int>(c - 1);
  }
  return of;
}

}  // namespace hyselam_objects

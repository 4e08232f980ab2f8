#include "hyselam_common/assignment.hpp"

#include <algorithm>

namespace hyselam {

void Assignment::reset(int rows, int columns) {
  columns_ = columns;
  const auto r = static_cast<std::size_t>(rows);
  const auto c = static_cast<std::size_t>(columns);
  cost_.assign(r * c, kNotAllowed);
  without_.assign(r, kNotAllowed);
  u_.assign(r, 0.0);
  v_.assign(c, 0.0);
  row_of_.assign(c, -1);
  column_of_.assign(r, -1);
  distance_.resize(c);
  before_.resize(c);
  price_.resize(c);
}

/// Distances of all columns from the row that is added. Without branches, as the loops below: they
/// take most of the time.
void Assignment::setDistances(int row) {
  const double* costs = cost_.data() + index(row, 0);
  const auto columns = static_cast<std::size_t>(columns_);
  for (std::size_t c = 0; c < columns; ++c) {
    price_[c] = v_[c];
    distance_[c] = costs[c] - v_[c];
    before_[c] = row;
  }
}

/// Shortens distances by paths through another row, which is this far from the new one.
void Assignment::relaxDistances(int from, double distance) {
  const double* costs = cost_.data() + index(from, 0);
  const double u = u_[static_cast<std::size_t>(from)];
  const auto columns = static_cast<std::size_t>(columns_);
  for (std::size_t c = 0; c < columns; ++c) {
    const double d = distance + costs[c] - u - price_[c];
    const bool nearer = d < distance_[c];
    distance_[c] = nearer ? d : distance_[c];
    before_[c] = nearer ? from : before_[c];
  }
}

int Assignment::nearestColumn() const {
  const auto columns = static_cast<std::size_t>(columns_);
  const double* d = distance_.data();
  double a = std::numeric_limits<double>::infinity(), b = a;
  std::size_t c = 0;
  for (; c + 1 < columns; c += 2) {
    a = std::min(a, d[c]);
    b = std::min(b, d[c + 1]);
  }
  if (c < columns) a = std::min(a, d[c]);
  const double least = std::min(a, b);
  if (least == std::numeric_limits<double>::infinity()) return -1;
  return static_cast<int>(std::find(d, d + columns, least) - d);
}

double Assignment::addRow(int row) {
  // Shortest path from the new row to a free column, or to a row that goes without.
  double best = std::numeric_limits<double>::infinity();  // of the known ends of paths
  int best_row = -1;                                      // goes without
  int last = -1;                                          // free column
  int from = row;
  double distance = 0.0;
  final_.clear();
  while (true) {
    const auto f = static_cast<std::size_t>(from);
    const double alone = distance + without_[f] - u_[f];
    if (alone < best) {
      best = alone;
      best_row = from;
    }
    if (from == row) {
      setDistances(row);
    } else {
      relaxDistances(from, distance);
    }
    const int next = nearestColumn();
    if (next < 0) break;
    const auto k = static_cast<std::size_t>(next);
    const double nearest = distance_[k];
    if (nearest >= best) break;
    if (row_of_[k] < 0) {
      best = nearest;
      best_row = -1;
      last = next;
      break;
    }
    // Its distance is final: no other path is shorter.
    final_.push_back({k, nearest});
    distance_[k] = std::numeric_limits<double>::infinity();
    price_[k] = -std::numeric_limits<double>::infinity();
    distance = nearest;
    from = row_of_[k];
  }
  // New dual values.
  u_[static_cast<std::size_t>(row)] += best;
  for (const FinalColumn& column : final_) {
    const double slack = best - column.distance;
    u_[static_cast<std::size_t>(row_of_[column.number])] += slack;
    v_[column.number] -= slack;
  }
  // Augment along the path.
  int column = last;
  if (best_row >= 0) {
    column = column_of_[static_cast<std::size_t>(best_row)];
    column_of_[static_cast<std::size_t>(best_row)] = -1;
    if (best_row == row) return best;
  }
  while (column >= 0) {
    const int owner = before_[static_cast<std::size_t>(column)];
    row_of_[static_cast<std::size_t>(column)] = owner;
    const int previous = column_of_[static_cast<std::size_t>(owner)];
    column_of_[static_cast<std::size_t>(owner)] = column;
    if (owner == row) break;
    column = previous;
  }
  return best;
}

}  // namespace hyselam

#include "assignment_bound.hpp"

#include <algorithm>

namespace hyselam_topo::merging {

void AssignmentBound::reset(int rows, int columns) {
  columns_ = columns;
  const auto r = static_cast<std::size_t>(rows);
  const auto c = static_cast<std::size_t>(columns);
  cost_.assign(r * c, kNever);
  without_.assign(r, kNever);
  u_.assign(r, 0.0);
  v_.assign(c, 0.0);
  row_of_.assign(c, -1);
  column_of_.assign(r, -1);
  distance_.resize(c);
  before_.resize(c);
  done_.resize(c);
}

double AssignmentBound::addRow(int row) {
  // Shortest path from the new row to a free column, or to a row that goes without.
  std::fill(distance_.begin(), distance_.end(), std::numeric_limits<double>::infinity());
  std::fill(done_.begin(), done_.end(), 0);
  double best = std::numeric_limits<double>::infinity();  // of the ends that are known
  int best_row = -1;                                      // goes without
  int last = -1;                                          // free column
  int from = row;
  double so_far = 0.0;
  while (true) {
    const auto f = static_cast<std::size_t>(from);
    const double alone = so_far + without_[f] - u_[f];
    if (alone < best) {
      best = alone;
      best_row = from;
    }
    const double* costs = cost_.data() + index(from, 0);
    double nearest = std::numeric_limits<double>::infinity();
    int next = -1;
    for (int c = 0; c < columns_; ++c) {
      const auto k = static_cast<std::size_t>(c);
      if (done_[k]) continue;
      const double d = so_far + costs[c] - u_[f] - v_[k];
      if (d < distance_[k]) {
        distance_[k] = d;
        before_[k] = from;
      }
      if (distance_[k] < nearest) {
        nearest = distance_[k];
        next = c;
      }
    }
    if (next < 0 || nearest >= best) break;
    const auto k = static_cast<std::size_t>(next);
    if (row_of_[k] < 0) {
      best = nearest;
      best_row = -1;
      last = next;
      break;
    }
    done_[k] = 1;
    so_far = nearest;
    from = row_of_[k];
  }
  // New dual values.
  u_[static_cast<std::size_t>(row)] += best;
  for (int c = 0; c < columns_; ++c) {
    const auto k = static_cast<std::size_t>(c);
    if (!done_[k]) continue;
    const double slack = best - distance_[k];
    u_[static_cast<std::size_t>(row_of_[k])] += slack;
    v_[k] -= slack;
  }
  // Turn the path around.
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

}  // namespace hyselam_topo::merging

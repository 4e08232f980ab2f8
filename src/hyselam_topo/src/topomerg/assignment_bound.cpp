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
  price_.resize(c);
}

// Loops without branches: they are most of the work.
void AssignmentBound::start(int row) {
  const double* costs = cost_.data() + index(row, 0);
  const auto columns = static_cast<std::size_t>(columns_);
  for (std::size_t c = 0; c < columns; ++c) {
    price_[c] = v_[c];
    distance_[c] = costs[c] - v_[c];
    before_[c] = row;
  }
}

void AssignmentBound::goOn(int from, double so_far) {
  const double* costs = cost_.data() + index(from, 0);
  const double u = u_[static_cast<std::size_t>(from)];
  const auto columns = static_cast<std::size_t>(columns_);
  for (std::size_t c = 0; c < columns; ++c) {
    const double d = so_far + costs[c] - u - price_[c];
    const bool nearer = d < distance_[c];
    distance_[c] = nearer ? d : distance_[c];
    before_[c] = nearer ? from : before_[c];
  }
}

int AssignmentBound::nearestColumn() const {
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

double AssignmentBound::addRow(int row) {
  // Shortest path from the new row to a free column, or to a row that goes without.
  double best = std::numeric_limits<double>::infinity();  // of the ends that are known
  int best_row = -1;                                      // goes without
  int last = -1;                                          // free column
  int from = row;
  double so_far = 0.0;
  done_.clear();
  while (true) {
    const auto f = static_cast<std::size_t>(from);
    const double alone = so_far + without_[f] - u_[f];
    if (alone < best) {
      best = alone;
      best_row = from;
    }
    if (from == row)
      start(row);
    else
      goOn(from, so_far);
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
    // Its distance is final: no other path leads to it.
    done_.push_back({k, nearest});
    distance_[k] = std::numeric_limits<double>::infinity();
    price_[k] = -std::numeric_limits<double>::infinity();
    so_far = nearest;
    from = row_of_[k];
  }
  // New dual values.
  u_[static_cast<std::size_t>(row)] += best;
  for (const Done& column : done_) {
    const double slack = best - column.distance;
    u_[static_cast<std::size_t>(row_of_[column.number])] += slack;
    v_[column.number] -= slack;
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

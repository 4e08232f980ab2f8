// The cheapest way to give each of some names a vertex of its own, or none: what any answer loses
// at least. The Hungarian method, row by row.
#pragma once

#include <limits>
#include <vector>

namespace hyselam_topo::merging {

constexpr double kNever = 1e9;  ///< cost of what is not allowed

class AssignmentBound {
 public:
  /// Makes room for a table of costs, all kNever, and for what each row costs without a column.
  void reset(int rows, int columns);
  double& cost(int row, int column) { return cost_[index(row, column)]; }
  double cost(int row, int column) const { return cost_[index(row, column)]; }
  double& without(int row) { return without_[static_cast<std::size_t>(row)]; }
  double without(int row) const { return without_[static_cast<std::size_t>(row)]; }

  /// Adds a row, whose costs (>= 0) are set; rows come in their order. Returns by how much the
  /// least sum of costs of all rows so far grows.
  double addRow(int row);

  /// After the last row: how much more it costs at least if this row takes this column, or none.
  double reduced(int row, int column, double cost) const {
    return cost - u_[static_cast<std::size_t>(row)] - v_[static_cast<std::size_t>(column)];
  }
  double reducedWithout(int row) const {
    return without_[static_cast<std::size_t>(row)] - u_[static_cast<std::size_t>(row)];
  }

 private:
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  int columns_ = 0;
  std::vector<double> cost_, without_;
  std::vector<double> u_, v_;  ///< dual values of rows and columns, v <= 0
  std::vector<int> row_of_;    ///< of each column, -1: free
  // Of one search for a path:
  struct Done {
    std::size_t number;
    double distance;
  };
  /// Distances of all columns from the row that is added, ...
  void start(int row);
  /// ... shortened by ways through another row, which is so far away.
  void goOn(int from, double so_far);
  int nearestColumn() const;

  std::vector<double> distance_;  ///< infinite for columns that are done
  std::vector<double> price_;     ///< v, minus infinity for columns that are done
  std::vector<int> before_;       ///< row from which a column was reached
  std::vector<Done> done_;
  std::vector<int> column_of_;  ///< of each row, -1: none
};

}  // namespace hyselam_topo::merging

// Assignment of rows to columns at the least sum of costs, where rows may go without a column: the
// Hungarian method, row by row (shortest augmenting paths).
#pragma once

#include <limits>
#include <vector>

namespace hyselam {

class Assignment {
 public:
  static constexpr double kNotAllowed = 1e9;  ///< cost of a pair that is not allowed

  /// Makes room for a table of costs and for the cost of each row without a column, all
  /// kNotAllowed.
  void reset(int rows, int columns);
  double& cost(int row, int column) { return cost_[index(row, column)]; }
  double cost(int row, int column) const { return cost_[index(row, column)]; }
  double& without(int row) { return without_[static_cast<std::size_t>(row)]; }
  double without(int row) const { return without_[static_cast<std::size_t>(row)]; }

  /// Adds a row, whose costs (>= 0) are set; rows come in their order. Returns the increase of the
  /// least sum of costs of all rows so far.
  double addRow(int row);

  /// The column of a row in the present assignment; -1: none.
  int columnOf(int row) const { return column_of_[static_cast<std::size_t>(row)]; }

  /// After the last row: a lower bound of the increase of the sum if the row takes this column at
  /// this cost, or none.
  double reduced(int row, int column, double cost) const {
    return cost - u_[static_cast<std::size_t>(row)] - v_[static_cast<std::size_t>(column)];
  }
  double reducedWithout(int row) const {
    return without_[static_cast<std::size_t>(row)] - u_[static_cast<std::size_t>(row)];
  }

 private:
  struct FinalColumn {
    std::size_t number;
    double distance;
  };
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  void setDistances(int row);
  void relaxDistances(int from, double distance);
  int nearestColumn() const;

  int columns_ = 0;
  std::vector<double> cost_, without_;
  std::vector<double> u_, v_;   ///< dual values of rows and columns, v <= 0
  std::vector<int> row_of_;     ///< of each column, -1: free
  std::vector<int> column_of_;  ///< of each row, -1: none
  // Of the search for one augmenting path:
  std::vector<double> distance_;  ///< of each column, infinite once it is final
  std::vector<double> price_;     ///< v, minus infinity for final columns
  std::vector<int> before_;       ///< row from which a column was reached
  std::vector<FinalColumn> final_;
};

}  // namespace hyselam

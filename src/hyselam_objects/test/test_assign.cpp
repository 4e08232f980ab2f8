// The least cost of all together, against trying all.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "hyselam_common/rng.hpp"
#include "mapping/assign.hpp"

using hyselam_objects::assignRows;

namespace {

double best(const std::vector<std::vector<double>>& cost, double without, std::size_t row,
            std::vector<char>& taken) {
  if (row == cost.size()) return 0.0;
  double least = without + best(cost, without, row + 1, taken);
  for (std::size_t c = 0; c < cost[row].size(); ++c) {
    if (taken[c] != 0 || cost[row][c] > without) continue;
    taken[c] = 1;
    least = std::min(least, cost[row][c] + best(cost, without, row + 1, taken));
    taken[c] = 0;
  }
  return least;
}

}  // namespace

TEST(HungarianAssignment, HasTheSmallestTotalCost) {
  hyselam::Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    const auto rows = static_cast<std::size_t>(1 + i % 6),
               columns = static_cast<std::size_t>(i % 5);
    std::vector<std::vector<double>> cost(rows, std::vector<double>(columns));
    for (auto& row : cost) {
      for (double& c : row) {
        c = rng.uniform();
        if (c > 0.8) c = std::numeric_limits<double>::infinity();
      }
    }
    const double without = i % 2 == 0 ? 0.5 : 2.0;
    const std::vector<int> of = assignRows(cost, without);
    ASSERT_EQ(of.size(), rows);
    double sum = 0.0;
    std::vector<char> taken(columns, 0);
    for (std::size_t r = 0; r < rows; ++r) {
      sum += of[r] < 0 ? without : cost[r][static_cast<std::size_t>(of[r])];
      if (of[r] < 0) continue;
      EXPECT_EQ(taken[static_cast<std::size_t>(of[r])]++, 0);
    }
    std::vector<char> none(columns, 0);
    EXPECT_NEAR(sum, best(cost, without, 0, none), 1e-9);
  }
  EXPECT_TRUE(assignRows({}, 1.0).empty());
}

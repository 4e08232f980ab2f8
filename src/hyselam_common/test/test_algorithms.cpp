// Disjoint sets and assignments, against plain definitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "hyselam_common/assignment.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/union_find.hpp"

namespace hyselam {
namespace {

TEST(UnionFind, RepresentativeIsTheSmallestMember) {
  UnionFind sets(6);
  EXPECT_TRUE(sets.unite(4, 2));
  EXPECT_TRUE(sets.unite(5, 4));
  EXPECT_FALSE(sets.unite(2, 5));
  EXPECT_EQ(sets.find(5), 2);
  EXPECT_EQ(sets.find(3), 3);
  EXPECT_TRUE(sets.connected(4, 5));
  EXPECT_FALSE(sets.connected(0, 5));
  EXPECT_EQ(sets.add(), 6);
  EXPECT_EQ(sets.find(6), 6);
  EXPECT_EQ(sets.size(), 7U);
}

TEST(UnionFind, EqualsLabelsThatAreRewritten) {
  Rng rng(3);
  for (int round = 0; round < 50; ++round) {
    constexpr int kSize = 40;
    UnionFind sets(kSize);
    std::vector<int> label(kSize);
    std::iota(label.begin(), label.end(), 0);
    for (int k = 0; k < 30; ++k) {
      const int a = static_cast<int>(rng.below(kSize)), b = static_cast<int>(rng.below(kSize));
      sets.unite(a, b);
      const auto [low, high] =
          std::minmax(label[static_cast<std::size_t>(a)], label[static_cast<std::size_t>(b)]);
      std::replace(label.begin(), label.end(), int{high}, int{low});
    }
    for (int i = 0; i < kSize; ++i) EXPECT_EQ(sets.find(i), label[static_cast<std::size_t>(i)]);
  }
}

/// The least sum of costs, by trying all assignments from `row` on.
double leastSum(const Assignment& table, int rows, int columns, int row, unsigned taken) {
  if (row == rows) return 0.0;
  double least = table.without(row) + leastSum(table, rows, columns, row + 1, taken);
  for (int c = 0; c < columns; ++c) {
    if ((taken >> c & 1U) != 0U) continue;
    least = std::min(least,
                     table.cost(row, c) + leastSum(table, rows, columns, row + 1, taken | 1U << c));
  }
  return least;
}

TEST(Assignment, EqualsTheBestOfAll) {
  Rng rng(5);
  for (int round = 0; round < 300; ++round) {
    const int rows = 1 + static_cast<int>(rng.below(5));
    const int columns = static_cast<int>(rng.below(6));
    Assignment table;
    table.reset(rows, columns);
    for (int r = 0; r < rows; ++r) {
      table.without(r) = rng.uniform(0.0, 1.5);
      for (int c = 0; c < columns; ++c) {
        if (rng.uniform() < 0.8) table.cost(r, c) = rng.uniform();
      }
    }
    double sum = 0.0;
    for (int r = 0; r < rows; ++r) sum += table.addRow(r);
    EXPECT_NEAR(sum, leastSum(table, rows, columns, 0, 0U), 1e-9);
    double of_columns = 0.0;
    std::vector<int> taken;
    for (int r = 0; r < rows; ++r) {
      const int column = table.columnOf(r);
      of_columns += column < 0 ? table.without(r) : table.cost(r, column);
      if (column >= 0) taken.push_back(column);
    }
    EXPECT_NEAR(of_columns, sum, 1e-9);
    std::sort(taken.begin(), taken.end());
    EXPECT_EQ(std::adjacent_find(taken.begin(), taken.end()), taken.end());
  }
}

TEST(Assignment, ReducedCostsBoundTheSumOfOtherAssignments) {
  Rng rng(6);
  Assignment table;
  table.reset(4, 4);
  for (int r = 0; r < 4; ++r) {
    table.without(r) = 2.0;
    for (int c = 0; c < 4; ++c) table.cost(r, c) = rng.uniform();
  }
  double sum = 0.0;
  for (int r = 0; r < 4; ++r) sum += table.addRow(r);
  for (int r = 0; r < 4; ++r) {
    EXPECT_NEAR(table.reduced(r, table.columnOf(r), table.cost(r, table.columnOf(r))), 0.0, 1e-12);
    EXPECT_GE(table.reducedWithout(r), -1e-12);
    for (int c = 0; c < 4; ++c) EXPECT_GE(table.reduced(r, c, table.cost(r, c)), -1e-12);
  }
  EXPECT_GT(sum, 0.0);
}

}  // namespace
}  // namespace hyselam

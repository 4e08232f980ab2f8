#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "hyselam_common/rng.hpp"
#include "hyselam_common/tiled_grid.hpp"

namespace hyselam {
namespace {

TEST(TiledGrid, HoldsWhatADenseOneWouldHowEverItGrows) {
  Rng rng(1);
  for (int round = 0; round < 20; ++round) {
    TiledGrid<int> grid;
    std::map<std::pair<int, int>, int> expected;  // by y, x
    for (int i = 0; i < 200; ++i) {
      const int reach = 1 + 10 * i;
      const int x = static_cast<int>(rng.below(static_cast<std::uint32_t>(reach))) - reach / 2;
      const int y = static_cast<int>(rng.below(static_cast<std::uint32_t>(reach))) - reach / 2;
      grid.cover(x, y, x, y);
      *grid.at(x, y) += i + 1;
      expected[{y, x}] += i + 1;
    }
    for (const auto& [cell, value] : expected) {
      const int* found = grid.find(cell.second, cell.first);
      ASSERT_NE(found, nullptr);
      EXPECT_EQ(*found, value);
    }
    // All of them, and row by row.
    auto next = expected.begin();
    grid.forEach([&](int x, int y, int value) {
      if (value == 0) return;
      ASSERT_NE(next, expected.end());
      EXPECT_EQ(next->first, std::make_pair(y, x));
      EXPECT_EQ(next->second, value);
      ++next;
    });
    EXPECT_EQ(next, expected.end());
  }
}

TEST(TiledGrid, IsEmptyWhereNothingWasWritten) {
  TiledGrid<int> grid;
  EXPECT_TRUE(grid.empty());
  EXPECT_EQ(grid.find(0, 0), nullptr);
  grid.cover(-100, -100, 1000, 1000);
  EXPECT_EQ(grid.find(500, 500), nullptr);
  *grid.at(-1, -64) = 3;
  EXPECT_EQ(*grid.find(-1, -64), 3);
  EXPECT_EQ(*grid.find(-64, -1), 0);       // of the same tile
  EXPECT_EQ(grid.find(0, -64), nullptr);   // beside it
  EXPECT_EQ(grid.find(5000, 0), nullptr);  // beyond the box
  EXPECT_EQ(grid.find(0, -5000), nullptr);
  std::size_t cells = 0;
  grid.forEach([&](int, int, int) { ++cells; });
  EXPECT_EQ(cells, 64U * 64U);
  grid.clear();
  EXPECT_TRUE(grid.empty());
  EXPECT_EQ(grid.find(-1, -64), nullptr);
}

}  // namespace
}  // namespace hyselam

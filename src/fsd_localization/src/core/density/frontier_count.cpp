#include "fsd_localization/density/frontier_count.hpp"

#include <algorithm>
#include <vector>

#include "row_flood.hpp"

namespace fsd_localization {

template <int W>
int FreeSpaceDensity::RowFlood<W>::frontierCount(const FreeSpaceGrid& space, Cell center,
                                                 double min_share) const {
  Rows free{}, reached{}, border{};
  cutOut(space.free, center, free);
  if (!fillFromCenter(free, reached)) return 0;
  for (int j = 0; j <= 2 * h_; ++j) {
    border[j] = spread(reached, j) & wholeRow(space.free, center, j) & ~disc_[at(j)];
  }
  return countGroups(border, min_share * 2.0 * hyselam::kPi * h_);
}

template <int W>
int FreeSpaceDensity::RowFlood<W>::countGroups(Rows& cells, double min_size) const {
  int groups = 0;
  std::vector<Cell> stack;
  for (int j = 0; j <= 2 * h_; ++j) {
    for (int w = 0; w < W; ++w) {
      while (cells[j].words[w] != 0) {
        const int i = 64 * w + __builtin_ctzll(cells[j].words[w]);
        int size = 0;
        stack.assign(1, {i, j});
        take(cells, i, j);
        while (!stack.empty()) {
          const Cell c = stack.back();
          stack.pop_back();
          ++size;
          for (int y = std::max(c.y - 1, 0); y <= std::min(c.y + 1, 2 * h_); ++y) {
            for (int x = std::max(c.x - 1, 0); x <= std::min(c.x + 1, 2 * h_); ++x) {
              if (take(cells, x, y)) stack.push_back({x, y});
            }
          }
        }
        if (size > min_size) ++groups;
      }
    }
  }
  return groups;
}
template <int W>
bool FreeSpaceDensity::RowFlood<W>::take(Rows& cells, int i, int j) {
  std::uint64_t& word = cells[at(j)].words[i / 64];
  const std::uint64_t bit = std::uint64_t{1} << (i % 64);
  const bool was_set = (word & bit) != 0;
  word &= ~bit;
  return was_set;
}

template int FreeSpaceDensity::RowFlood<1>::frontierCount(const FreeSpaceGrid&, Cell, double) const;
template int FreeSpaceDensity::RowFlood<2>::frontierCount(const FreeSpaceGrid&, Cell, double) const;
template int FreeSpaceDensity::RowFlood<3>::frontierCount(const FreeSpaceGrid&, Cell, double) const;
template int FreeSpaceDensity::RowFlood<4>::frontierCount(const FreeSpaceGrid&, Cell, double) const;

int frontierCount(const FreeSpaceDensity& density, const FreeSpaceGrid& space, Cell center,
                  double min_share) {
  return density.flood_->frontierCount(space, center, min_share);
}

}  // namespace fsd_localization

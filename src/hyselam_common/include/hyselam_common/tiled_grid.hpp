// Cells of a plane of which few are used: a building is long corridors around much that nobody
// sees.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace hyselam {

/// A box of cells that takes memory where some are used: tiles of 64 by 64 cells, made when one of
/// theirs is asked for to be written. All cells begin as `Cell{}`. Growing the box moves no cell.
template <typename Cell>
class TiledGrid {
 public:
  static constexpr int kSide = 64;  ///< of a tile [cells]

  /// Makes the box as large as needed for these cells; it may get some more.
  void cover(int min_x, int min_y, int max_x, int max_y) {
    const bool empty = tiles_.empty();
    const int x0 = empty ? tileOf(min_x) : std::min(x0_, tileOf(min_x));
    const int y0 = empty ? tileOf(min_y) : std::min(y0_, tileOf(min_y));
    const int x1 = empty ? tileOf(max_x) : std::max(x0_ + columns_ - 1, tileOf(max_x));
    const int y1 = empty ? tileOf(max_y) : std::max(y0_ + rows_ - 1, tileOf(max_y));
    const int columns = x1 - x0 + 1, rows = y1 - y0 + 1;
    if (columns == columns_ && rows == rows_) return;
    std::vector<Tile> grown(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        const int to = (y + y0_ - y0) * columns + x + x0_ - x0;
        grown[static_cast<std::size_t>(to)] = std::move(tile(x, y));
      }
    }
    tiles_ = std::move(grown);
    x0_ = x0;
    y0_ = y0;
    columns_ = columns;
    rows_ = rows;
  }
  /// No cell is left, nor any memory.
  void clear() { *this = TiledGrid{}; }
  bool empty() const { return tiles_.empty(); }

  /// A cell of the box, to be written. Its neighbor in the tile is one beside it in memory along x,
  /// `kSide` along y.
  Cell* at(int x, int y) {
    Tile& t = tile(tileOf(x) - x0_, tileOf(y) - y0_);
    if (t.empty()) t.resize(kSide * kSide);
    return &t[inTile(x, y)];
  }
  /// The same to be read; null where nothing was written around it, and outside of the box.
  const Cell* find(int x, int y) const {
    const int column = tileOf(x) - x0_, row = tileOf(y) - y0_;
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return nullptr;
    const Tile& t = tile(column, row);
    return t.empty() ? nullptr : &t[inTile(x, y)];
  }
  /// Calls `use(x, y, cell)` for all that take memory, row by row, each from the left.
  template <typename Use>
  void forEach(Use use) const {
    for (int y = y0_ * kSide; y < (y0_ + rows_) * kSide; ++y) {
      for (int column = 0; column < columns_; ++column) {
        const Tile& t = tile(column, tileOf(y) - y0_);
        if (t.empty()) continue;
        const int x = (x0_ + column) * kSide;
        const Cell* row = &t[inTile(x, y)];
        for (int i = 0; i < kSide; ++i) use(x + i, y, row[i]);
      }
    }
  }

 private:
  using Tile = std::vector<Cell>;  // empty, or all cells

  static int tileOf(int cell) { return cell >= 0 ? cell / kSide : -((-cell - 1) / kSide) - 1; }
  static std::size_t inTile(int x, int y) {
    return static_cast<std::size_t>((y - tileOf(y) * kSide) * kSide + x - tileOf(x) * kSide);
  }
  Tile& tile(int column, int row) {
    return tiles_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }
  const Tile& tile(int column, int row) const {
    return tiles_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }

  int x0_ = 0, y0_ = 0, columns_ = 0, rows_ = 0;  // [tiles]
  std::vector<Tile> tiles_;
};

}  // namespace hyselam

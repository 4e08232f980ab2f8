// Which part of an image a pixel counts for: whole, halves, triangles about a point, columns.
#pragma once

#include <cstdint>
#include <vector>

namespace selovis {

/// Columns of one row up to `end` (not included) count for `region`; a row's spans cover all
/// columns.
struct Span {
  int end;
  int region;
};

struct Layout {
  int rows = 0, cols = 0, regions = 0;
  std::vector<std::uint32_t> row_begin;  ///< first span of each row, rows + 1 values
  std::vector<Span> spans;
};

/// Each function remakes `layout` for an image size, without allocating once it has been that
/// large.
void wholeLayout(int rows, int cols, Layout& layout);
/// Region 0: the upper rows / 2 rows; 1: the others.
void halvesLayout(int rows, int cols, Layout& layout);
/// A grid of parts x parts regions, row by row.
void gridLayout(int rows, int cols, int parts, Layout& layout);
/// Four triangles that meet in pixel (x, y): 0 above, 1 left, 2 right, 3 below.
/// Above the point a pixel (u, v) is left where u * y < v * x, right where (cols - u) * y <= v *
/// (cols - x).
void irisLayout(int rows, int cols, int x, int y, Layout& layout);
/// Column i of n covers the pixels from i * cols / n on and counts for region_of[i].
void columnsLayout(int rows, int cols, const std::vector<int>& region_of, int regions,
                   Layout& layout);

}  // namespace selovis

// The regions of an image that histograms are computed of (dos Santos 2014, 6.3.3): whole, halves,
// a grid, triangles around a point, columns.
#pragma once

#include <cstdint>
#include <vector>

namespace selovis {

/// The columns of one row up to `end` (not included) belong to `region`; the spans of a row cover
/// all columns.
struct RegionSpan {
  int end;
  int region;
};

struct RegionLayout {
  int rows = 0, cols = 0, regions = 0;
  std::vector<std::uint32_t> row_begin;  ///< first span of each row, rows + 1 values
  std::vector<RegionSpan> spans;
};

/// Each function computes `layout` for an image size; no memory is allocated once it has been that
/// large.
void wholeLayout(int rows, int cols, RegionLayout& layout);
/// Region 0: the upper rows / 2 rows; 1: the others.
void halvesLayout(int rows, int cols, RegionLayout& layout);
/// A grid of parts x parts regions, row by row.
void gridLayout(int rows, int cols, int parts, RegionLayout& layout);
/// Four triangles that meet in pixel (x, y): 0 above, 1 left, 2 right, 3 below.
/// Above the point a pixel (u, v) is left where u * y < v * x, right where (cols - u) * y <= v *
/// (cols - x).
void irisLayout(int rows, int cols, int x, int y, RegionLayout& layout);
/// Column i of n covers the pixels from i * cols / n on and belongs to region_of[i].
void columnsLayout(int rows, int cols, const std::vector<int>& region_of, int regions,
                   RegionLayout& layout);

}  // namespace selovis

#include "selovis/descriptors/region_layout.hpp"

#include <algorithm>

namespace selovis {
namespace {

void start(RegionLayout& layout, int rows, int cols, int regions) {
  layout.rows = rows;
  layout.cols = cols;
  layout.regions = regions;
  layout.row_begin.clear();
  layout.spans.clear();
}

void newRow(RegionLayout& layout) {
  layout.row_begin.push_back(static_cast<std::uint32_t>(layout.spans.size()));
}

/// Smallest u >= 0 with u * a >= b, for a > 0.
int ceilDiv(long long b, long long a) {
  return b <= 0 ? 0 : static_cast<int>((b + a - 1) / a);
}

}  // namespace

void wholeLayout(int rows, int cols, RegionLayout& layout) {
  start(layout, rows, cols, 1);
  for (int v = 0; v < rows; ++v) {
    newRow(layout);
    layout.spans.push_back({cols, 0});
  }
  newRow(layout);
}

void halvesLayout(int rows, int cols, RegionLayout& layout) {
  start(layout, rows, cols, 2);
  for (int v = 0; v < rows; ++v) {
    newRow(layout);
    layout.spans.push_back({cols, v < rows / 2 ? 0 : 1});
  }
  newRow(layout);
}

void gridLayout(int rows, int cols, int parts, RegionLayout& layout) {
  start(layout, rows, cols, parts * parts);
  for (int v = 0; v < rows; ++v) {
    newRow(layout);
    const int band =
        std::min(static_cast<int>(static_cast<long long>(v) * parts / rows), parts - 1);
    for (int i = 0; i < parts; ++i) {
      const int end = static_cast<int>(static_cast<long long>(i + 1) * cols / parts);
      layout.spans.push_back({end, band * parts + i});
    }
  }
  newRow(layout);
}

void irisLayout(int rows, int cols, int x, int y, RegionLayout& layout) {
  start(layout, rows, cols, 4);
  x = std::clamp(x, 1, std::max(1, cols - 1));
  y = std::clamp(y, 1, std::max(1, rows - 1));
  for (int v = 0; v < rows; ++v) {
    newRow(layout);
    const bool above = v < y;
    // Distance from the nearer edge, and the height of the triangles on this side of the point.
    const long long depth = above ? v : rows - v, height = above ? y : rows - y;
    const int left = ceilDiv(depth * x, height);
    // (cols - u) * height <= depth * (cols - x)  <=>  u >= cols - depth * (cols - x) / height
    const int right = cols - static_cast<int>(depth * (cols - x) / height);
    layout.spans.push_back({std::min(left, cols), 1});
    layout.spans.push_back({std::clamp(right, std::min(left, cols), cols), above ? 0 : 3});
    layout.spans.push_back({cols, 2});
  }
  newRow(layout);
}

void columnsLayout(int rows, int cols, const std::vector<int>& region_of, int regions,
                   RegionLayout& layout) {
  start(layout, rows, cols, regions);
  const long long n = static_cast<long long>(region_of.size());
  for (int v = 0; v < rows; ++v) {
    newRow(layout);
    for (long long i = 0; i < n; ++i) {
      const int end = static_cast<int>((i + 1) * cols / n);
      const int region = region_of[static_cast<std::size_t>(i)];
      // Neighbours of one region make one run.
      if (i > 0 && layout.spans.back().region == region) {
        layout.spans.back().end = end;
      } else {
        layout.spans.push_back({end, region});
      }
    }
  }
  newRow(layout);
}

}  // namespace selovis

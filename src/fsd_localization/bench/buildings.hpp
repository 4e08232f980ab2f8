// Floors of offices for benches: rooms of 4 to 8 m along corridors of 3 m, doors of 1 m, furniture.
#pragma once

#include <algorithm>
#include <random>

#include "hyselam_common/occupancy_grid.hpp"

namespace bench {

/// A square floor of `side` cells of 0.1 m; everything inside the outer wall is free or occupied.
inline hyselam::OccupancyGrid building(int side, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  const auto upTo = [&rng](int n) { return static_cast<int>(rng() % static_cast<unsigned>(n)); };
  hyselam::GridGeometry g;
  g.width = g.height = side;
  g.resolution = 0.1;
  hyselam::OccupancyGrid map(g, hyselam::OccupancyGrid::kFree);
  const auto fill = [&map](int x0, int y0, int x1, int y1, std::int8_t v) {
    for (int y = std::max(0, y0); y < std::min(map.geometry.height, y1); ++y) {
      for (int x = std::max(0, x0); x < std::min(map.geometry.width, x1); ++x) map.at({x, y}) = v;
    }
  };
  constexpr std::int8_t kWall = hyselam::OccupancyGrid::kOccupied,
                        kOpen = hyselam::OccupancyGrid::kFree;
  // Corridors every 15 to 20 m, a row of rooms on either side of each.
  for (int y = 30; y < side;) {
    const int depth = 60 + upTo(25);
    fill(0, y, side, y + 2, kWall);                  // corridor wall
    fill(0, y + depth, side, y + depth + 2, kWall);  // back wall
    for (int x = 0; x < side;) {
      const int w = 40 + upTo(40), door = x + 8 + upTo(w - 20);
      fill(x, y, x + 2, y + depth, kWall);
      fill(door, y, door + 10, y + 2, kOpen);
      for (int k = upTo(4); k > 0; --k) {
        const int fx = x + 4 + upTo(w - 12), fy = y + 4 + upTo(depth - 12);
        fill(fx, fy, fx + 3 + upTo(8), fy + 3 + upTo(8), kWall);
      }
      x += w;
    }
    y += depth + 2 + 30;
    for (int x = 60; x < side; x += 300 + upTo(100)) {
      fill(x, y - depth - 32, x + 25, y - 30, kOpen);  // links
    }
  }
  fill(0, 0, side, 2, kWall);
  fill(0, side - 2, side, side, kWall);
  fill(0, 0, 2, side, kWall);
  fill(side - 2, 0, side, side, kWall);
  return map;
}

}  // namespace bench

#include "hyselam_gr2to/thesis/door_candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hyselam_common/pose2.hpp"

namespace hyselam_topo {

using hyselam::Cell;

std::vector<Cell> doorCells(const DistanceMap& distances, double min_radius, double max_radius) {
  std::array<Cell, 8> offsets;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double angle = 2.0 * hyselam::kPi * static_cast<double>(i) / 8.0;
    offsets[i] = {static_cast<int>(std::lround(min_radius * std::cos(angle))),
                  static_cast<int>(std::lround(min_radius * std::sin(angle)))};
  }
  std::vector<Cell> out;
  for (int y = 0; y < distances.height(); ++y) {
    for (int x = 0; x < distances.width(); ++x) {
      const double own = distances.squared({x, y});
      if (!(own > min_radius * min_radius && own < max_radius * max_radius)) continue;
      unsigned larger = 0;  // bit i: sample i
      for (std::size_t i = 0; i < offsets.size(); ++i) {
        const Cell c{x + offsets[i].x, y + offsets[i].y};
        if (c.x < 0 || c.y < 0 || c.x >= distances.width() || c.y >= distances.height()) continue;
        if (distances.squared(c) > own) larger |= 1u << i;
      }
      const unsigned turned = larger | larger << 8;
      // Steps of 3, 4 and, the other way round, 5.
      if ((larger & (turned >> 3 | turned >> 4)) != 0) out.push_back({x, y});
    }
  }
  return out;
}

std::vector<cv::Point2d> centralLocations(const std::vector<Cell>& cells, double radius) {
  struct Group {
    double x, y, count;
    Cell square;
  };
  std::vector<Group> groups;
  if (cells.empty()) return {};
  // Groups by squares as wide as the radius: one that is near lies in the cell's square or around.
  int width = 0, height = 0;
  for (const Cell& c : cells) {
    width = std::max(width, c.x);
    height = std::max(height, c.y);
  }
  const auto square_of = [&](double x, double y) {
    return Cell{static_cast<int>(x / radius) + 1, static_cast<int>(y / radius) + 1};
  };
  const Cell last = square_of(width, height);
  const int columns = last.x + 2;
  std::vector<std::vector<std::size_t>> squares(static_cast<std::size_t>(columns) *
                                                static_cast<std::size_t>(last.y + 2));
  const auto at = [&](Cell s) -> std::vector<std::size_t>& {
    return squares[static_cast<std::size_t>(s.y) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(s.x)];
  };
  for (const Cell& c : cells) {
    const Cell own = square_of(c.x, c.y);
    std::size_t first = groups.size();
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        for (const std::size_t k : at({own.x + dx, own.y + dy})) {
          const Group& g = groups[k];
          const double x = g.x / g.count - c.x, y = g.y / g.count - c.y;
          if (x * x + y * y < radius * radius) first = std::min(first, k);
        }
      }
    }
    if (first == groups.size()) {
      groups.push_back({static_cast<double>(c.x), static_cast<double>(c.y), 1.0, own});
      at(own).push_back(first);
      continue;
    }
    Group& g = groups[first];
    g.x += c.x;
    g.y += c.y;
    g.count += 1.0;
    const Cell now = square_of(g.x / g.count, g.y / g.count);
    if (now == g.square) continue;
    std::vector<std::size_t>& before = at(g.square);
    before.erase(std::find(before.begin(), before.end(), first));
    at(now).push_back(first);
    g.square = now;
  }
  std::vector<cv::Point2d> out;
  out.reserve(groups.size());
  for (const Group& g : groups) out.emplace_back(g.x / g.count, g.y / g.count);
  return out;
}

}  // namespace hyselam_topo

#include "hyselam_topo/door_candidates.hpp"

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
  };
  std::vector<Group> groups;
  for (const Cell& c : cells) {
    bool joined = false;
    for (Group& g : groups) {
      const double dx = g.x / g.count - c.x, dy = g.y / g.count - c.y;
      if (dx * dx + dy * dy >= radius * radius) continue;
      g = {g.x + c.x, g.y + c.y, g.count + 1.0};
      joined = true;
      break;
    }
    if (!joined) groups.push_back({static_cast<double>(c.x), static_cast<double>(c.y), 1.0});
  }
  std::vector<cv::Point2d> out;
  for (const Group& g : groups) out.emplace_back(g.x / g.count, g.y / g.count);
  return out;
}

}  // namespace hyselam_topo

// The steps of the thesis (dos Santos 2014, section 4.2) as they are written, with ERRATA's
// readings.
#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_gr2to/thesis/circles.hpp"
#include "hyselam_gr2to/thesis/distance_map.hpp"

namespace transcription {

/// Second stage, Eq. 4.2. Samples outside of the map count as 0.
inline std::vector<hyselam::Cell> doorCells(const hyselam_topo::DistanceMap& map, double min_pixel,
                                            double max_pixel) {
  std::vector<hyselam::Cell> out;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const double own = map.distance({x, y});
      if (!(min_pixel < own && own < max_pixel)) continue;
      double v[8];
      for (int i = 0; i < 8; ++i) {
        const int u =
            x + static_cast<int>(std::lround(min_pixel * std::cos(2 * 3.14159265358979 * i / 8)));
        const int w =
            y + static_cast<int>(std::lround(min_pixel * std::sin(2 * 3.14159265358979 * i / 8)));
        v[i] = u < 0 || w < 0 || u >= map.width() || w >= map.height() ? 0.0 : map.distance({u, w});
      }
      bool opposite = false;
      for (int i = 0; i < 8; ++i) {
        for (int j = i + 1; j < 8; ++j) {
          if (v[i] > own && v[j] > own && 2 < std::abs(i - j) && std::abs(i - j) < 6)
            opposite = true;
        }
      }
      if (opposite) out.push_back({x, y});
    }
  }
  return out;
}

/// Second stage: the central locations, every cell against every group.
inline std::vector<cv::Point2d> centralLocations(const std::vector<hyselam::Cell>& cells,
                                                 double radius) {
  struct Group {
    double x, y, count;
  };
  std::vector<Group> groups;
  for (const hyselam::Cell& c : cells) {
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

/// Fourth stage: the circles along the diagram, every one against every stored one.
inline std::vector<hyselam_topo::Circle> packCircles(const hyselam_topo::DistanceMap& map,
                                                     const cv::Mat& voronoi) {
  std::vector<hyselam_topo::Circle> stored;
  for (int y = 0; y < voronoi.rows; ++y) {
    for (int x = 0; x < voronoi.cols; ++x) {
      if (voronoi.at<std::uint8_t>(y, x) == 0) continue;
      const hyselam_topo::Circle c{{x, y}, map.distance({x, y})};
      bool larger = true;
      std::vector<hyselam_topo::Circle> others;
      for (const auto& s : stored) {
        const double d = std::hypot(s.centre.x - x, s.centre.y - y);
        if (s.radius + c.radius < d) {
          others.push_back(s);
        } else {
          larger = larger && c.radius > s.radius;
        }
      }
      if (!larger) continue;
      stored = others;
      stored.push_back(c);
    }
  }
  return stored;
}

}  // namespace transcription

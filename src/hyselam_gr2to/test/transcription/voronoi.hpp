// Distances, nearest obstacles and Voronoi diagram by their definitions, cell by cell: what the
// fast versions are compared with.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "hyselam_common/occupancy_grid.hpp"

namespace transcription {

using hyselam::Cell;

/// The nearest obstacle by looking at all; of equally near ones that with the smallest x, then y.
inline Cell nearestObstacle(const cv::Mat& obstacles, Cell c) {
  Cell best{-1, -1};
  long best_squared = -1;
  for (int x = 0; x < obstacles.cols; ++x) {
    for (int y = 0; y < obstacles.rows; ++y) {
      if (obstacles.at<std::uint8_t>(y, x) == 0) continue;
      const long dx = x - c.x, dy = y - c.y, squared = dx * dx + dy * dy;
      if (best_squared >= 0 && squared >= best_squared) continue;
      best = {x, y};
      best_squared = squared;
    }
  }
  return best;
}

inline long squaredDistance(Cell a, Cell b) {
  const long dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

/// Image of the nearest obstacles, CV_32SC2.
inline cv::Mat nearestObstacles(const cv::Mat& obstacles) {
  cv::Mat sites(obstacles.size(), CV_32SC2);
  for (int y = 0; y < obstacles.rows; ++y) {
    for (int x = 0; x < obstacles.cols; ++x) {
      const Cell s = nearestObstacle(obstacles, {x, y});
      sites.at<cv::Vec2i>(y, x) = {s.x, s.y};
    }
  }
  return sites;
}

/// Free cells p beside a free cell n (of four) with: the obstacles of p and n are no neighbours and
/// farther apart than a bump of the given depth makes them, and p loses no more than n by changing
/// to the obstacle of the other.
inline cv::Mat voronoiBorders(const cv::Mat& sites, double noise) {
  cv::Mat out(sites.size(), CV_8UC1, cv::Scalar(0));
  const auto site = [&](Cell c) {
    const cv::Vec2i s = sites.at<cv::Vec2i>(c.y, c.x);
    return Cell{s[0], s[1]};
  };
  for (int y = 0; y < sites.rows; ++y) {
    for (int x = 0; x < sites.cols; ++x) {
      const Cell p{x, y}, sp = site(p);
      if (sp.x < 0 || sp == p) continue;
      for (const Cell& n : {Cell{x + 1, y}, Cell{x - 1, y}, Cell{x, y + 1}, Cell{x, y - 1}}) {
        if (n.x < 0 || n.y < 0 || n.x >= sites.cols || n.y >= sites.rows) continue;
        const Cell sn = site(n);
        if (sn == n) continue;
        const double d = std::sqrt(
            static_cast<double>(std::max(squaredDistance(p, sp), squaredDistance(n, sn))));
        const auto apart = static_cast<double>(squaredDistance(sp, sn));
        if (apart <= 2.0 || apart <= 2.0 * d * noise + noise * noise + 1e-9) continue;
        const long loss_p = squaredDistance(p, sn) - squaredDistance(p, sp);
        const long loss_n = squaredDistance(n, sp) - squaredDistance(n, sn);
        if (loss_p <= loss_n) out.at<std::uint8_t>(y, x) = 255;
      }
    }
  }
  return out;
}

/// Two double passes of Guo and Hall's parallel thinning (A2, 1989) over the whole image.
inline cv::Mat thinned(const cv::Mat& borders) {
  cv::Mat now = borders.clone();
  for (int pass = 0; pass < 4; ++pass) {
    cv::Mat next = now.clone();
    for (int y = 0; y < now.rows; ++y) {
      for (int x = 0; x < now.cols; ++x) {
        if (now.at<std::uint8_t>(y, x) == 0) continue;
        const auto at = [&](int dx, int dy) {
          const int u = x + dx, v = y + dy;
          return u >= 0 && v >= 0 && u < now.cols && v < now.rows &&
                 now.at<std::uint8_t>(v, u) != 0;
        };
        const bool p2 = at(0, 1), p3 = at(1, 1), p4 = at(1, 0), p5 = at(1, -1), p6 = at(0, -1),
                   p7 = at(-1, -1), p8 = at(-1, 0), p9 = at(-1, 1);
        const int c =
            (!p2 && (p3 || p4)) + (!p4 && (p5 || p6)) + (!p6 && (p7 || p8)) + (!p8 && (p9 || p2));
        const int n1 = (p9 || p2) + (p3 || p4) + (p5 || p6) + (p7 || p8);
        const int n2 = (p2 || p3) + (p4 || p5) + (p6 || p7) + (p8 || p9);
        const int n = std::min(n1, n2);
        const bool m = pass % 2 == 0 ? ((p2 || p3 || !p5) && p4) : ((p6 || p7 || !p9) && p8);
        if (c == 1 && n >= 2 && n <= 3 && !m) next.at<std::uint8_t>(y, x) = 0;
      }
    }
    now = next;
  }
  return now;
}

}  // namespace transcription

#include "hyselam_gr2to/thesis/critical_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace hyselam_topo {

using hyselam::Cell;

namespace {

// The obstacle near a cell that is farthest from the one nearest to it: the other side.
Cell otherBasis(const DistanceMap& distances, Cell at) {
  const Cell own = distances.site(at);
  Cell best = own;
  long farthest = -1;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Cell n{at.x + dx, at.y + dy};
      if (n.x < 0 || n.y < 0 || n.x >= distances.width() || n.y >= distances.height()) continue;
      const Cell s = distances.site(n);
      const long sx = s.x - own.x, sy = s.y - own.y;
      if (sx * sx + sy * sy <= farthest) continue;
      farthest = sx * sx + sy * sy;
      best = s;
    }
  }
  return best;
}

}  // namespace

std::vector<CriticalPoint> findCriticalPoints(const DistanceMap& distances, const cv::Mat& lines,
                                              double radius) {
  const int reach = std::max(1, static_cast<int>(std::floor(radius)));
  cv::Mat marks(lines.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < lines.rows; ++y) {
    for (int x = 0; x < lines.cols; ++x) {
      if (lines.at<std::uint8_t>(y, x) == 0) continue;
      const std::int32_t own = distances.squared({x, y});
      bool least = true;
      std::int32_t largest = own;
      int neighbours = 0;
      for (int v = std::max(0, y - reach); least && v <= std::min(lines.rows - 1, y + reach); ++v) {
        const std::uint8_t* row = lines.ptr<std::uint8_t>(v);
        for (int u = std::max(0, x - reach); u <= std::min(lines.cols - 1, x + reach); ++u) {
          if (row[u] == 0) continue;
          const int squared = (u - x) * (u - x) + (v - y) * (v - y);
          if (squared > radius * radius) continue;
          const std::int32_t d = distances.squared({u, v});
          if (d < own) {
            least = false;
            break;
          }
          largest = std::max(largest, d);
          if (squared > 0 && squared <= 2) ++neighbours;
        }
      }
      const bool narrows =
          std::sqrt(static_cast<double>(largest)) > std::sqrt(static_cast<double>(own)) + 0.5;
      if (least && narrows && neighbours >= 2) marks.at<std::uint8_t>(y, x) = 255;
    }
  }
  cv::Mat groups, stats, means;
  const int count = cv::connectedComponentsWithStats(marks, groups, stats, means, 8, CV_32S);
  std::vector<CriticalPoint> out(static_cast<std::size_t>(std::max(0, count - 1)));
  std::vector<double> nearest(out.size(), std::numeric_limits<double>::infinity());
  for (int y = 0; y < lines.rows; ++y) {
    for (int x = 0; x < lines.cols; ++x) {
      const int group = groups.at<int>(y, x);
      if (group == 0) continue;
      const auto k = static_cast<std::size_t>(group - 1);
      const double d = std::hypot(x - means.at<double>(group, 0), y - means.at<double>(group, 1));
      if (d >= nearest[k]) continue;
      nearest[k] = d;
      out[k].at = {x, y};
    }
  }
  for (CriticalPoint& p : out) {
    p.clearance = distances.distance(p.at);
    p.basis_a = distances.site(p.at);
    p.basis_b = otherBasis(distances, p.at);
  }
  std::sort(out.begin(), out.end(), [](const CriticalPoint& p, const CriticalPoint& q) {
    return p.at.y != q.at.y ? p.at.y < q.at.y : p.at.x < q.at.x;
  });
  return out;
}

}  // namespace hyselam_topo

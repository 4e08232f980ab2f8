// How well two segmentations of one map agree.
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <utility>

/// Adjusted Rand index over cells that both have in places.
inline double agreement(const cv::Mat& a, const cv::Mat& b) {
  std::map<std::pair<int, int>, double> both;
  std::map<int, double> rows, columns;
  double n = 0.0;
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x) {
      const int p = a.at<std::uint16_t>(y, x), q = b.at<std::uint16_t>(y, x);
      if (p == 0 || q == 0) continue;
      both[{p, q}] += 1.0;
      rows[p] += 1.0;
      columns[q] += 1.0;
      n += 1.0;
    }
  }
  const auto pairs = [](const auto& counts) {
    double sum = 0.0;
    for (const auto& [key, count] : counts) sum += 0.5 * count * (count - 1.0);
    return sum;
  };
  const double expected = pairs(rows) * pairs(columns) / (0.5 * n * (n - 1.0));
  return (pairs(both) - expected) / (0.5 * (pairs(rows) + pairs(columns)) - expected);
}

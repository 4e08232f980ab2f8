// The equations of 6.3.1 as they stand, pixel by pixel, for comparison. Integers where the text has
// fractions: a sample is at least the mean of m pixels where m times it is at least their sum.
#pragma once

#include <cmath>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace plain {

using Pixel = std::function<int(int x, int y)>;  // grey value

inline int lbp(const Pixel& g, int x, int y, int radius, bool disc_mean) {
  long sum = g(x, y), count = 1;
  if (radius > 1 && disc_mean) {  // 6.3.1.3, last paragraph
    sum = count = 0;
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -radius; dx <= radius; ++dx) {
        if (dx * dx + dy * dy > radius * radius) continue;
        sum += g(x + dx, y + dy);
        ++count;
      }
    }
  }
  int code = 0;
  for (int p = 0; p < 8; ++p) {  // Eq. 6.3 to 6.6
    const double angle = 2.0 * 3.14159265358979323846 * p / 8.0;
    const int xp = x + static_cast<int>(std::lround(radius * std::cos(angle)));
    const int yp = y - static_cast<int>(std::lround(radius * std::sin(angle)));
    if (count * g(xp, yp) >= sum) code |= 1 << p;
  }
  return code;
}

/// Eq. 6.10.
inline bool isUniform(int code) {
  const auto s = [&](int p) { return (code >> p) & 1; };
  int u = std::abs(s(7) - s(0));
  for (int p = 1; p < 8; ++p) u += std::abs(s(p) - s(p - 1));
  return u <= 2;
}

/// Labels in ascending order of the code, all others last.
inline int uniformLabel(int code) {
  if (!isUniform(code)) return 58;
  int label = 0;
  for (int c = 0; c < code; ++c) label += isUniform(c);
  return label;
}

/// Eq. 6.13 with hue and saturation as exact fractions.
inline int colorClass(const cv::Vec3b& bgr, int n, int value_min, int saturation_min) {
  const int b = bgr[0], g = bgr[1], r = bgr[2];
  const int max = std::max(b, std::max(g, r)), min = std::min(b, std::min(g, r)), d = max - min;
  if (max < value_min) return 0;
  if (255 * d < saturation_min * max) return 1;
  if (d == 0) return 2;
  // The hue is 60 degrees * num / d; kappa is 360 / (n - 2).
  int num = 0;
  if (max == r)
    num = g - b + (g < b ? 6 * d : 0);
  else if (max == g)
    num = 2 * d + b - r;
  else
    num = 4 * d + r - g;
  return num * (n - 2) / (6 * d) + 2;
}

inline int gray(const cv::Vec3b& bgr) {
  return (29 * bgr[0] + 150 * bgr[1] + 77 * bgr[2] + 128) >> 8;
}

/// One region of LBPbyHSV-XnY's first stage: member(x, y) tells whether a pixel counts. Counts, not
/// shares.
inline std::vector<int> byColor(const cv::Mat& image, bool uniform, int n, int value_min,
                                int saturation_min, int radius, bool disc_mean,
                                const std::function<bool(int, int)>& member) {
  const int labels = uniform ? 59 : 256;
  std::vector<int> h(static_cast<std::size_t>(labels * n), 0);
  const Pixel g = [&](int x, int y) { return gray(image.at<cv::Vec3b>(y, x)); };
  for (int y = radius; y < image.rows - radius; ++y) {
    for (int x = radius; x < image.cols - radius; ++x) {
      if (!member(x, y)) continue;
      const int code = lbp(g, x, y, radius, disc_mean);
      const int c = colorClass(image.at<cv::Vec3b>(y, x), n, value_min, saturation_min);
      ++h[static_cast<std::size_t>(c * labels + (uniform ? uniformLabel(code) : code))];
    }
  }
  return h;
}

/// The second stage: LBP of the image of Eq. 6.14.
inline std::vector<int> secondStage(const cv::Mat& image, bool uniform, int n, int value_min,
                                    int saturation_min, int radius, bool disc_mean) {
  const int rows = image.rows - 2 * radius, cols = image.cols - 2 * radius;
  std::vector<int> h(uniform ? 59 : 256, 0);
  if (rows <= 0 || cols <= 0) return h;
  const Pixel g = [&](int x, int y) { return gray(image.at<cv::Vec3b>(y, x)); };
  cv::Mat inner(rows, cols, CV_32S);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      inner.at<int>(y, x) = uniformLabel(lbp(g, x + radius, y + radius, radius, disc_mean)) +
                            59 * colorClass(image.at<cv::Vec3b>(y + radius, x + radius), n,
                                            value_min, saturation_min);
    }
  }
  const Pixel i = [&](int x, int y) { return inner.at<int>(y, x); };
  for (int y = radius; y < rows - radius; ++y) {
    for (int x = radius; x < cols - radius; ++x) {
      const int code = lbp(i, x, y, radius, disc_mean);
      ++h[static_cast<std::size_t>(uniform ? uniformLabel(code) : code)];
    }
  }
  return h;
}

}  // namespace plain

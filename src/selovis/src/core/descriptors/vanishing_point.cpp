#include "selovis/descriptors/vanishing_point.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "descriptor_terms.hpp"

namespace selovis {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr int kCells = 20;         // per axis, over the middle half of the image
constexpr int kMinGradient = 60;   // Sobel units: a step of 15 grey levels
constexpr float kMinShare = 2.5f;  // votes of the best cell over the mean of all

}  // namespace

cv::Point2f VanishingPoint::find(const cv::Mat& image) {
  const cv::Point2f middle(static_cast<float>(image.cols) / 2.0f,
                           static_cast<float>(image.rows) / 2.0f);
  cv::resize(image, small_, cv::Size(kWidth, kHeight), 0.0, 0.0, cv::INTER_AREA);
  const cv::Mat& gray = grayOf(small_, "the vanishing point", gray_);
  cv::Sobel(gray, dx_, CV_16S, 1, 0);
  cv::Sobel(gray, dy_, CV_16S, 0, 1);
  votes_.assign(kCells * kCells, 0.0f);
  const float cell_w = 0.5f * kWidth / kCells, cell_h = 0.5f * kHeight / kCells;
  float all = 0.0f;
  for (int v = 1; v + 1 < kHeight; ++v) {
    const short* gx = dx_.ptr<short>(v);
    const short* gy = dy_.ptr<short>(v);
    for (int u = 1; u + 1 < kWidth; ++u) {
      const int ax = std::abs(gx[u]), ay = std::abs(gy[u]);
      // Oblique only: upright and level lines are those of walls and doors seen square on.
      if (ax + ay < kMinGradient || 5 * ax < ay || 5 * ay < ax) continue;
      // The edge runs along (-gy, gx): level v + (x - u) * slope.
      const float slope = -static_cast<float>(gx[u]) / static_cast<float>(gy[u]);
      for (int i = 0; i < kCells; ++i) {
        const float x = kWidth * 0.25f + (static_cast<float>(i) + 0.5f) * cell_w;
        if (std::abs(x - static_cast<float>(u)) < 8.0f) continue;  // too near to tell a direction
        const float y = static_cast<float>(v) + (x - static_cast<float>(u)) * slope;
        const float j = (y - kHeight * 0.25f) / cell_h;
        if (j < 0.0f || j >= static_cast<float>(kCells)) continue;
        votes_[static_cast<std::size_t>(j) * kCells + static_cast<std::size_t>(i)] += 1.0f;
        all += 1.0f;
      }
    }
  }
  const auto best = std::max_element(votes_.begin(), votes_.end());
  if (*best <= kMinShare * all / static_cast<float>(kCells * kCells)) return middle;
  const int at = static_cast<int>(best - votes_.begin()), col = at % kCells, row = at / kCells;
  const float x = kWidth * 0.25f + (static_cast<float>(col) + 0.5f) * cell_w;
  const float y = kHeight * 0.25f + (static_cast<float>(row) + 0.5f) * cell_h;
  return {x * static_cast<float>(image.cols) / kWidth,
          y * static_cast<float>(image.rows) / kHeight};
}

}  // namespace selovis

// LGOP: orientations of the gradients of the logarithm of brightness, in cells of two sizes.
//
// A lamp or a window changes brightness by a factor, which the logarithm makes a constant that the
// gradient does not see; without regard to its sign an edge between a wall and a window stays
// itself by day and by night. Each cell is divided by its own energy: what counts is the shape of
// what is in it, not its contrast. The classifier's square root makes Euclid's distance that of
// Hellinger.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "descriptor_terms.hpp"

namespace selovis {
namespace {

constexpr int kWidth = 320, kHeight = 240;  // the image is brought to this size
constexpr int kBins = 9;                    // of half a turn
constexpr int kRows[2] = {3, 6}, kCols[2] = {4, 8};
constexpr float kFloor = 0.02f;  // of the whole image's energy, added to each cell's

class GradientPyramid : public Descriptor {
 public:
  GradientPyramid() : log_(1, 256, CV_32F), cells_(kRows[1] * kCols[1] * (kBins + 1)) {
    for (int i = 0; i < 256; ++i) log_.at<float>(i) = 40.0f * std::log1p(static_cast<float>(i));
  }
  int size() const override { return (kRows[0] * kCols[0] + kRows[1] * kCols[1]) * kBins; }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    const cv::Mat& gray = grayOf(image, "LGOP", gray_);
    cv::resize(gray, small_, cv::Size(kWidth, kHeight), 0.0, 0.0, cv::INTER_AREA);
    cv::LUT(small_, log_, logarithm_);
    cv::Sobel(logarithm_, dx_, CV_32F, 1, 0);
    cv::Sobel(logarithm_, dy_, CV_32F, 0, 1);
    cv::cartToPolar(dx_, dy_, magnitude_, angle_);
    collect();
    const float floor = kFloor * total_;
    // The coarse cells are blocks of 2 x 2 fine ones.
    for (int level = 0; level < 2; ++level) {
      const int rows = kRows[level], cols = kCols[level], block = level == 0 ? 2 : 1;
      const float weight = 1.0f / static_cast<float>(rows * cols);
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < cols; ++c, out += kBins) {
          float sum[kBins] = {}, energy = floor;
          for (int i = 0; i < block * block; ++i) {
            const int cell = (r * block + i / block) * kCols[1] + c * block + i % block;
            for (int k = 0; k < kBins; ++k) {
              sum[k] += cells_[static_cast<std::size_t>(cell * kBins + k)];
              energy += cells_[static_cast<std::size_t>(cell * kBins + k)];
            }
          }
          for (int k = 0; k < kBins; ++k) {
            out[k] = energy > 0.0f ? weight * sum[k] / energy : 0.0f;
          }
        }
      }
    }
  }

 private:
  /// Magnitudes by orientation and fine cell; each is shared by its two nearest orientations.
  void collect() {
    std::fill(cells_.begin(), cells_.end(), 0.0f);
    constexpr int kCellW = kWidth / kCols[1], kCellH = kHeight / kRows[1];
    const float to_bin = static_cast<float>(kBins / hyselam::kPi);
    for (int y = 0; y < kHeight; ++y) {
      const float* magnitude = magnitude_.ptr<float>(y);
      const float* angle = angle_.ptr<float>(y);
      for (int c = 0; c < kCols[1]; ++c) {
        float bins[2 * kBins + 2] = {};
        for (int x = c * kCellW; x < (c + 1) * kCellW; ++x) {
          const float at = angle[x] * to_bin;
          const int low = std::min(static_cast<int>(at), 2 * kBins);
          const float share = magnitude[x] * (at - static_cast<float>(low));
          bins[low] += magnitude[x] - share;
          bins[low + 1] += share;
        }
        float* cell = cells_.data() + (y / kCellH * kCols[1] + c) * kBins;
        for (int k = 0; k < 2 * kBins + 2; ++k) cell[k % kBins] += bins[k];
      }
    }
    total_ = 0.0f;
    for (int i = 0; i < kRows[1] * kCols[1] * kBins; ++i)
      total_ += cells_[static_cast<std::size_t>(i)];
  }

  cv::Mat log_, gray_, small_, logarithm_, dx_, dy_, magnitude_, angle_;
  std::vector<float> cells_;
  float total_ = 0.0f;
};

}  // namespace

DescriptorPtr makeGradientPyramid(const std::string& name, const DescriptorParams& /*params*/) {
  return name == "LGOP" ? std::make_unique<GradientPyramid>() : nullptr;
}

}  // namespace selovis

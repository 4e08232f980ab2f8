// Small pictures: HSV-HIST, how much there is of each colour; LOGCHROMA, RANKS and GRAY, where.
//
// LOGCHROMA is indifferent to the colour and the strength of the light. A lamp or a white balance
// multiplies each channel of the whole image by a factor (von Kries), so the logarithms of the
// ratios of channels move by a constant. Of all constants the mean is the one that brings two
// images nearest to each other in the sense of least squares; with the means taken out, the
// distance of two signatures is that of the images after the best adaptation of one to the other.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "descriptor_terms.hpp"
#include "selovis/descriptors/color_lbp.hpp"

namespace selovis {
namespace {

constexpr int kHistogramWidth = 160, kHistogramHeight = 120;
constexpr int kHues = 16, kSaturations = 4, kValues = 4;

class HsvHistogram : public Descriptor {
 public:
  int size() const override { return kHues * kSaturations * kValues; }
  std::vector<SignaturePart> parts() const override { return {{"HSV-HIST", size(), 0.5, true}}; }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    requireColor(image, "HSV-HIST");
    cv::resize(image, small_, cv::Size(kHistogramWidth, kHistogramHeight), 0.0, 0.0,
               cv::INTER_AREA);
    cv::cvtColor(small_, hsv_, cv::COLOR_BGR2HSV);
    std::fill(out, out + size(), 0.0f);
    constexpr float kPixel = 1.0f / (kHistogramWidth * kHistogramHeight);
    for (int y = 0; y < kHistogramHeight; ++y) {
      const std::uint8_t* row = hsv_.ptr<std::uint8_t>(y);
      for (int x = 0; x < kHistogramWidth; ++x, row += 3) {
        const int hue = row[0] * kHues / 180, saturation = row[1] * kSaturations / 256,
                  value = row[2] * kValues / 256;
        out[(hue * kSaturations + saturation) * kValues + value] += kPixel;
      }
    }
  }

 private:
  cv::Mat small_, hsv_;
};

constexpr int kColumns = 16, kRows = 12;
constexpr float kDark = 12.0f;  // added to 8-bit values: the noise of dark cells has no say

class LogChromaLayout : public Descriptor {
 public:
  int size() const override { return 2 * kColumns * kRows; }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    requireColor(image, "LOGCHROMA");
    cv::resize(image, small_, cv::Size(kColumns, kRows), 0.0, 0.0, cv::INTER_AREA);
    constexpr int kCells = kColumns * kRows;
    float red_mean = 0.0f, blue_mean = 0.0f;
    for (int i = 0; i < kCells; ++i) {
      const std::uint8_t* bgr = small_.ptr<std::uint8_t>(i / kColumns) + 3 * (i % kColumns);
      const float green = std::log(static_cast<float>(bgr[1]) + kDark);
      out[i] = std::log(static_cast<float>(bgr[2]) + kDark) - green;
      out[kCells + i] = std::log(static_cast<float>(bgr[0]) + kDark) - green;
      red_mean += out[i] / kCells;
      blue_mean += out[kCells + i] / kCells;
    }
    for (int i = 0; i < kCells; ++i) {
      out[i] -= red_mean;
      out[kCells + i] -= blue_mean;
    }
  }
  std::vector<SignaturePart> parts() const override { return {{"LOGCHROMA", size(), 1.0}}; }

 private:
  cv::Mat small_;
};

/// Ranks of the cells of a thumbnail within each channel: any increasing change of a channel
/// (exposure, gamma, white balance) leaves them as they are.
class RankLayout : public Descriptor {
 public:
  int size() const override { return 3 * kColumns * kRows; }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    requireColor(image, "RANKS");
    cv::resize(image, small_, cv::Size(kColumns, kRows), 0.0, 0.0, cv::INTER_AREA);
    constexpr int kCells = kColumns * kRows;
    for (int c = 0; c < 3; ++c, out += kCells) {
      int upTo[256] = {};  // cells of each value, then of each value and those below it
      for (int i = 0; i < kCells; ++i) ++upTo[valueAt(i, c)];
      for (int v = 1; v < 256; ++v) upTo[v] += upTo[v - 1];
      for (int i = 0; i < kCells; ++i) {
        const int v = valueAt(i, c), below = v > 0 ? upTo[v - 1] : 0;
        out[i] = (0.5f * static_cast<float>(below + upTo[v])) / kCells - 0.5f;
      }
    }
  }
  std::vector<SignaturePart> parts() const override { return {{"RANKS", size(), 1.0}}; }

 private:
  int valueAt(int i, int channel) const {
    return small_.ptr<std::uint8_t>(i / kColumns)[3 * (i % kColumns) + channel];
  }

  cv::Mat small_;
};

constexpr int kGrayColumns = 32, kGrayRows = 24;
constexpr float kGrayContrast = 8.0f;  // added to the standard deviation: bare walls stay flat

/// A gray thumbnail, its mean and contrast taken out: the plainest signature of all.
class GrayLayout : public Descriptor {
 public:
  int size() const override { return kGrayColumns * kGrayRows; }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    const cv::Mat& gray = grayOf(image, "GRAY", gray_);
    cv::resize(gray, small_, cv::Size(kGrayColumns, kGrayRows), 0.0, 0.0, cv::INTER_AREA);
    cv::Scalar mean, deviation;
    cv::meanStdDev(small_, mean, deviation);
    const float offset = static_cast<float>(mean[0]),
                contrast = static_cast<float>(deviation[0]) + kGrayContrast;
    for (int i = 0; i < size(); ++i) {
      out[i] =
          (static_cast<float>(small_.ptr(i / kGrayColumns)[i % kGrayColumns]) - offset) / contrast;
    }
  }
  std::vector<SignaturePart> parts() const override { return {{"GRAY", size(), 1.0}}; }

 private:
  cv::Mat gray_, small_;
};

}  // namespace

DescriptorPtr makeColorLayout(const std::string& name, const DescriptorParams& /*params*/) {
  if (name == "HSV-HIST") return std::make_unique<HsvHistogram>();
  if (name == "LOGCHROMA") return std::make_unique<LogChromaLayout>();
  if (name == "GRAY") return std::make_unique<GrayLayout>();
  if (name == "RANKS") return std::make_unique<RankLayout>();
  return nullptr;
}

}  // namespace selovis

// What the text compares LBPbyHSV with: LBP histograms of grey, of the HSV channels, of a pyramid.
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "descriptor_terms.hpp"
#include "selovis/descriptors/color_lbp.hpp"
#include "selovis/descriptors/region_layout.hpp"

namespace selovis {
namespace {

/// Codes of one 8-bit channel of `image` counted by region: regions x 256.
void countChannel(const cv::Mat& image, int channel, const RegionLayout& layout,
                  LbpStream<std::uint8_t>& stream, int radius, std::vector<std::uint32_t>& counts) {
  counts.assign(static_cast<std::size_t>(layout.regions) * kLbpCodes, 0);
  const int channels = image.channels();
  stream.begin(image.cols);
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* in = image.ptr<std::uint8_t>(y) + channel;
    std::uint8_t* row = stream.next();
    for (int x = 0; x < image.cols; ++x) row[x] = in[x * channels];
    if (!stream.push()) continue;
    const int center = y - radius;
    const std::uint8_t* codes = stream.codes();
    int x = radius;
    for (std::uint32_t s = layout.row_begin[center]; s < layout.row_begin[center + 1]; ++s) {
      std::uint32_t* bins =
          counts.data() + static_cast<std::size_t>(layout.spans[s].region) * kLbpCodes;
      for (; x < std::min(layout.spans[s].end, image.cols - radius); ++x) ++bins[codes[x]];
    }
  }
}

enum class Bins { kAll, kUniform59, kUniform58 };

int binCount(Bins bins) {
  return bins == Bins::kAll ? kLbpCodes : bins == Bins::kUniform59 ? kUniformLabels : kUniformCodes;
}

void putBins(const std::uint32_t* counts, Bins bins, float scale, float* out) {
  std::fill(out, out + binCount(bins), 0.0f);
  for (int code = 0; code < kLbpCodes; ++code) {
    const int bin = bins == Bins::kAll ? code : uniformLabels()[code];
    if (bin < binCount(bins)) out[bin] += scale * static_cast<float>(counts[code]);
  }
}

float perPixel(const cv::Mat& image, int radius) {
  const int rows = image.rows - 2 * radius, cols = image.cols - 2 * radius;
  return rows > 0 && cols > 0 ? 1.0f / (static_cast<float>(rows) * static_cast<float>(cols)) : 0.0f;
}

/// LBP8,R and CENTRIST: any 8-bit image; SLBP: 1 + 4 + 16 cells of it.
class GrayLbp : public Descriptor {
 public:
  GrayLbp(const LbpParams& lbp, Bins bins, bool pyramid)
      : radius_(lbp.radius), bins_(bins), pyramid_(pyramid), stream_(lbp) {}
  int size() const override { return binCount(bins_) * (pyramid_ ? 21 : 1); }
  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    const cv::Mat& gray = grayOf(image, "LBP", gray_);
    const int parts = pyramid_ ? 4 : 1;
    if (layout_.rows != gray.rows || layout_.cols != gray.cols) {
      gridLayout(gray.rows, gray.cols, parts, layout_);
    }
    countChannel(gray, 0, layout_, stream_, radius_, counts_);
    const float scale = perPixel(gray, radius_);
    const int n = binCount(bins_);
    if (!pyramid_) return putBins(counts_.data(), bins_, scale, out);
    float* fine = out + 5 * n;  // whole, 2 x 2, 4 x 4
    std::fill(out, fine, 0.0f);
    for (int i = 0; i < 16; ++i) {
      putBins(counts_.data() + i * kLbpCodes, bins_, scale, fine + i * n);
      const int half = 1 + (i / 8) * 2 + (i % 4) / 2;
      for (int k = 0; k < n; ++k) {
        out[k] += fine[i * n + k];
        out[half * n + k] += fine[i * n + k];
      }
    }
  }

 private:
  int radius_;
  Bins bins_;
  bool pyramid_;
  LbpStream<std::uint8_t> stream_;
  RegionLayout layout_;
  cv::Mat gray_;
  std::vector<std::uint32_t> counts_;
};

/// HSV-LBP: one histogram per channel of OpenCV's 8-bit HSV image.
class HsvLbp : public Descriptor {
 public:
  HsvLbp(const LbpParams& lbp, Bins bins) : radius_(lbp.radius), bins_(bins), stream_(lbp) {}
  int size() const override { return 3 * binCount(bins_); }
  std::vector<SignaturePart> parts() const override { return {{"", size(), 0.5, true}}; }
  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    requireColor(image, "HSV-LBP");
    cv::cvtColor(image, hsv_, cv::COLOR_BGR2HSV);
    if (layout_.rows != image.rows || layout_.cols != image.cols) {
      wholeLayout(image.rows, image.cols, layout_);
    }
    for (int c = 0; c < 3; ++c) {
      countChannel(hsv_, c, layout_, stream_, radius_, counts_);
      putBins(counts_.data(), bins_, perPixel(image, radius_), out + c * binCount(bins_));
    }
  }

 private:
  int radius_;
  Bins bins_;
  LbpStream<std::uint8_t> stream_;
  RegionLayout layout_;
  cv::Mat hsv_;
  std::vector<std::uint32_t> counts_;
};

}  // namespace

DescriptorPtr makeLbpBaseline(const std::string& name, const DescriptorParams& params) {
  const LbpParams& lbp = params.lbp;
  if (name == "CENTRIST") return std::make_unique<GrayLbp>(LbpParams{1, false}, Bins::kAll, false);
  if (name == "HSV-LBP") return std::make_unique<HsvLbp>(lbp, Bins::kAll);
  if (name == "HSV-LBP-u") return std::make_unique<HsvLbp>(lbp, Bins::kUniform58);
  if (name == "SLBP") return std::make_unique<GrayLbp>(lbp, Bins::kUniform58, true);
  const bool uniform = name.size() > 2 && name.compare(name.size() - 2, 2, "-u") == 0;
  const int radius = numberAfter(uniform ? name.substr(0, name.size() - 2) : name, "LBP8,", 1, 9);
  if (radius < 0) return nullptr;
  return std::make_unique<GrayLbp>(LbpParams{radius, lbp.disc_mean},
                                   uniform ? Bins::kUniform59 : Bins::kAll, false);
}

}  // namespace selovis

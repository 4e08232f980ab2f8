// sLBP: LBPbyHSV whose image regions come from ranges (dos Santos 2014, 7.3.2); ranges of depth
// images.
#include <algorithm>
#include <cmath>
#include <limits>

#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"
#include "lbp_histogram.hpp"
#include "selovis/descriptors/color_lbp.hpp"

namespace selovis {
namespace {

/// sLBP-(N|A|S)LRFn: three sections, columns nearer than near_range, nearer than middle_range, the
/// rest. A adds their sum by color, S their sum over all colors.
class DepthLbp : public Descriptor {
 public:
  DepthLbp(char kind, int columns, const DescriptorParams& p)
      : kind_(kind),
        columns_(columns),
        params_(p),
        engine_(p.lbp, {kColors, p.value_min, p.saturation_min}, p.threads) {}

  int size() const override {
    return 3 * kPart + (kind_ == 'A' ? kPart : kind_ == 'S' ? kUniformLabels : 0);
  }
  std::vector<SignaturePart> parts() const override { return {{"", size(), 0.5, true}}; }

  void compute(const cv::Mat& image, const SensorReadings& readings, float* out) override {
    requireColor(image, "sLBP");
    if (readings.ranges.empty()) {
      throw hyselam::InputError("sLBP", "", "needs distances across the image, but there are none");
    }
    meanRanges(readings.ranges, columns_, means_);
    regions_.clear();
    for (const float d : means_) {
      regions_.push_back(d < params_.near_range ? 0 : d < params_.middle_range ? 1 : 2);
    }
    columnsLayout(image.rows, image.cols, regions_, 3, layout_);
    engine_.compute(image, layout_);
    std::fill(out, out + size(), 0.0f);
    const float scale = 1.0f / static_cast<float>(std::max<std::size_t>(1, engine_.total()));
    for (int i = 0; i < 3 * kColors; ++i) {
      const std::uint32_t* counts =
          engine_.counts().data() + static_cast<std::size_t>(i) * kLbpCodes;
      addCodeCounts(counts, true, scale, out + i * kUniformLabels);
      if (kind_ == 'A')
        addCodeCounts(counts, true, scale, out + 3 * kPart + i % kColors * kUniformLabels);
      if (kind_ == 'S') addCodeCounts(counts, true, scale, out + 3 * kPart);
    }
  }

  RequiredReadings requiredReadings() const override {
    RequiredReadings required;
    required.ranges = true;
    return required;
  }

 private:
  static constexpr int kColors = 8, kPart = kColors * kUniformLabels;
  char kind_;
  int columns_;
  DescriptorParams params_;
  ColorLbp engine_;
  RegionLayout layout_;
  std::vector<float> means_;
  std::vector<int> regions_;
};

}  // namespace

DescriptorPtr makeDepthLbp(const std::string& name, const DescriptorParams& params) {
  for (const char kind : {'N', 'A', 'S'}) {
    for (const std::string& prefix :
         {std::string("sLBP-(") + kind + ")LRF", std::string("sLBP-LRF(") + kind + ")"}) {
      const int n = numberAfter(name, prefix, 1, 1000);
      if (n > 0) return std::make_unique<DepthLbp>(kind, n, params);
    }
  }
  return nullptr;
}

void meanRanges(const std::vector<float>& ranges, int n, std::vector<float>& means) {
  means.clear();
  const int m = static_cast<int>(ranges.size());
  for (int i = 0; i < n; ++i) {
    int begin = static_cast<int>(static_cast<long long>(i) * m / n);
    const int end = std::max(begin + 1, static_cast<int>(static_cast<long long>(i + 1) * m / n));
    float sum = 0.0f;
    int count = 0;
    for (; begin < std::min(end, m); ++begin) {
      if (!std::isfinite(ranges[begin]) || ranges[begin] <= 0.0f) continue;
      sum += ranges[begin];
      ++count;
    }
    means.push_back(count > 0 ? sum / static_cast<float>(count)
                              : std::numeric_limits<float>::infinity());
  }
}

std::vector<float> rangesOfDepth(const cv::Mat& depth, int n) {
  if (depth.empty() || depth.type() != CV_16UC1) {
    throw hyselam::InputError("depth image", "", "must have one channel of 16 bits");
  }
  if (n < 1 || n > depth.cols) {
    throw hyselam::InputError("depth image", "", "has too few columns for " + std::to_string(n));
  }
  // The middle half of the rows: neither the floor nor the ceiling near the robot.
  const int top = depth.rows / 4, bottom = std::max(top + 1, depth.rows - depth.rows / 4);
  std::vector<float> result;
  std::vector<std::uint16_t> values;
  for (int i = 0; i < n; ++i) {
    values.clear();
    for (int y = top; y < bottom; ++y) {
      const std::uint16_t* row = depth.ptr<std::uint16_t>(y);
      for (int x = i * depth.cols / n; x < (i + 1) * depth.cols / n; ++x) {
        if (row[x] > 0) values.push_back(row[x]);
      }
    }
    if (values.empty()) {
      result.push_back(std::numeric_limits<float>::infinity());
      continue;
    }
    const auto tenth = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 10);
    std::nth_element(values.begin(), tenth, values.end());
    result.push_back(static_cast<float>(*tenth) / 1000.0f);
  }
  return result;
}

}  // namespace selovis

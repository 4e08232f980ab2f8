// LBPbyHSV-XnY with its image regions (dos Santos 2014, 6.3.1.3 and 6.3.3).
#include <algorithm>
#include <cmath>

#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"
#include "lbp_histogram.hpp"
#include "selovis/descriptors/color_lbp.hpp"
#include "selovis/descriptors/vanishing_point.hpp"

namespace selovis {
namespace {

enum class Regions { kWhole, kHalves, kIris, kIrisVanishing };

struct Variant {
  bool uniform = true;  // labels of the first stage: U (uniform) or S (all codes)
  int colors = 8;
  char second = 'N';  // second stage: N (none), U or S
  Regions regions = Regions::kWhole;
  int firstLabels() const { return uniform ? kUniformLabels : kLbpCodes; }
  int secondLabels() const {
    return second == 'N' ? 0 : second == 'U' ? kUniformLabels : kLbpCodes;
  }
};

class LbpByHsv : public Descriptor {
 public:
  LbpByHsv(const Variant& variant, const DescriptorParams& p)
      : variant_(variant),
        engine_(p.lbp, {variant.colors, p.value_min, p.saturation_min}, p.threads) {
    if (variant.second != 'N') {
      second_ =
          std::make_unique<LbpStream<std::uint16_t>>(p.lbp, variant.colors * kUniformLabels - 1);
    }
  }

  int size() const override {
    return variant_.firstLabels() * variant_.colors * regionCount() + variant_.secondLabels();
  }

  std::vector<SignaturePart> parts() const override { return {{"", size(), 0.5, true}}; }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    requireColor(image, "LBPbyHSV");
    makeLayout(image);
    const bool second = variant_.second != 'N';
    engine_.compute(image, layout_, second ? &patterns_ : nullptr);
    std::fill(out, out + size(), 0.0f);
    const float scale = 1.0f / static_cast<float>(std::max<std::size_t>(1, engine_.total()));
    const int labels = variant_.firstLabels(), part = labels * variant_.colors;
    for (int r = 0; r < layout_.regions; ++r) {
      for (int c = 0; c < variant_.colors; ++c) {
        const std::uint32_t* counts =
            engine_.counts().data() + static_cast<std::size_t>(r * variant_.colors + c) * kLbpCodes;
        addCodeCounts(counts, variant_.uniform, scale, out + r * part + c * labels);
      }
    }
    if (layout_.regions > 1) {  // and their sum
      float* sum = out + layout_.regions * part;
      for (int r = 0; r < layout_.regions; ++r) {
        for (int k = 0; k < part; ++k) sum[k] += out[r * part + k];
      }
    }
    if (second) secondStage(out + part * regionCount());
  }

 private:
  int regionCount() const {
    return variant_.regions == Regions::kWhole ? 1 : variant_.regions == Regions::kHalves ? 3 : 5;
  }

  void makeLayout(const cv::Mat& image) {
    const bool kept = layout_.rows == image.rows && layout_.cols == image.cols;
    switch (variant_.regions) {
      case Regions::kWhole:
        if (!kept) wholeLayout(image.rows, image.cols, layout_);
        break;
      case Regions::kHalves:
        if (!kept) halvesLayout(image.rows, image.cols, layout_);
        break;
      case Regions::kIris:
        if (!kept) irisLayout(image.rows, image.cols, image.cols / 2, image.rows / 2, layout_);
        break;
      case Regions::kIrisVanishing: {
        const cv::Point2f at = vanishing_.find(image);
        irisLayout(image.rows, image.cols, static_cast<int>(std::lround(at.x)),
                   static_cast<int>(std::lround(at.y)), layout_);
        break;
      }
    }
  }

  /// Histogram of the patterns of the image of Eq. 6.14, label + color * (number of labels).
  void secondStage(float* out) {
    const int radius = engine_.lbpParams().radius, rows = patterns_.rows - 2 * radius,
              cols = patterns_.cols - 2 * radius;
    if (rows <= 2 * radius || cols <= 2 * radius) return;
    std::uint32_t counts[kLbpCodes] = {};
    const auto& labels = uniformLabels();
    second_->begin(cols);
    for (int y = 0; y < rows; ++y) {
      const std::uint16_t* p = patterns_.ptr<std::uint16_t>(y + radius) + radius;
      std::uint16_t* row = second_->next();
      for (int x = 0; x < cols; ++x) {
        row[x] = static_cast<std::uint16_t>(labels[p[x] & 255] + (p[x] >> 8) * kUniformLabels);
      }
      if (!second_->push()) continue;
      const std::uint8_t* codes = second_->codes();
      for (int x = radius; x < cols - radius; ++x) ++counts[codes[x]];
    }
    const float scale = 1.0f / static_cast<float>((rows - 2 * radius) * (cols - 2 * radius));
    addCodeCounts(counts, variant_.second == 'U', scale, out);
  }

  Variant variant_;
  ColorLbp engine_;
  RegionLayout layout_;
  VanishingPoint vanishing_;
  cv::Mat patterns_;
  std::unique_ptr<LbpStream<std::uint16_t>> second_;  // only if there is a second stage
};

}  // namespace

DescriptorPtr makeLbpByHsv(const std::string& name, const DescriptorParams& params) {
  const std::string prefix = "LBPbyHSV-";
  if (name.compare(0, prefix.size(), prefix) != 0) return nullptr;
  std::string rest = name.substr(prefix.size());
  Variant v;
  const auto ends = [&](const std::string& suffix) {
    if (rest.size() <= suffix.size() ||
        rest.compare(rest.size() - suffix.size(), suffix.size(), suffix) != 0) {
      return false;
    }
    rest.resize(rest.size() - suffix.size());
    return true;
  };
  if (ends("-IRIS-VP")) {
    v.regions = Regions::kIrisVanishing;
  } else if (ends("-IRIS")) {
    v.regions = Regions::kIris;
  } else if (ends("-D")) {
    v.regions = Regions::kHalves;
  }
  if (rest.size() < 3 || (rest.front() != 'U' && rest.front() != 'S') ||
      std::string("NUS").find(rest.back()) == std::string::npos) {
    return nullptr;
  }
  v.uniform = rest.front() == 'U';
  v.second = rest.back();
  v.colors = numberAfter(rest.substr(0, rest.size() - 1), rest.substr(0, 1), 3, 16);
  if (v.colors < 0) return nullptr;
  if (!v.uniform && v.second != 'N') {
    throw hyselam::InputError("descriptor '" + name + "'", "",
                              "a second stage needs the uniform first stage (U)");
  }
  return std::make_unique<LbpByHsv>(v, params);
}

}  // namespace selovis

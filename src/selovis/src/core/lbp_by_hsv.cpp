// LBPbyHSV-XnY with its regions (6.3.1.3, 6.3.3), and sLBP, whose regions come from distances
// (7.3.2).
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "descriptor_parts.hpp"
#include "selovis/color_lbp.hpp"
#include "selovis/vanishing_point.hpp"

namespace selovis {
namespace {

enum class Regions { kWhole, kHalves, kIris, kIrisVanishing };

struct Variant {
  bool uniform = true;  // first stage
  int colors = 8;
  char second = 'N';
  Regions regions = Regions::kWhole;
  int firstLabels() const { return uniform ? kUniformLabels : kLbpCodes; }
  int secondLabels() const {
    return second == 'N' ? 0 : second == 'U' ? kUniformLabels : kLbpCodes;
  }
};

/// Adds the 256 counts of one colour to its bins.
void fold(const std::uint32_t* counts, bool uniform, float scale, float* out) {
  if (!uniform) {
    for (int code = 0; code < kLbpCodes; ++code)
      out[code] += scale * static_cast<float>(counts[code]);
    return;
  }
  const auto& labels = uniformLabels();
  std::uint32_t bins[kUniformLabels] = {};
  for (int code = 0; code < kLbpCodes; ++code) bins[labels[code]] += counts[code];
  for (int k = 0; k < kUniformLabels; ++k) out[k] += scale * static_cast<float>(bins[k]);
}

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
    return variant_.firstLabels() * variant_.colors * parts() + variant_.secondLabels();
  }

  void compute(const cv::Mat& image, const Readings&, float* out) override {
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
        fold(counts, variant_.uniform, scale, out + r * part + c * labels);
      }
    }
    if (layout_.regions > 1) {  // and their sum
      float* sum = out + layout_.regions * part;
      for (int r = 0; r < layout_.regions; ++r) {
        for (int k = 0; k < part; ++k) sum[k] += out[r * part + k];
      }
    }
    if (second) secondStage(out + part * parts());
  }

 private:
  int parts() const {
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

  /// The patterns of the image of Eq. 6.14, label + colour * (number of labels).
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
    fold(counts, variant_.second == 'U', scale, out);
  }

  Variant variant_;
  ColorLbp engine_;
  Layout layout_;
  VanishingPoint vanishing_;
  cv::Mat patterns_;
  std::unique_ptr<LbpStream<std::uint16_t>> second_;  // only if there is a second stage
};

/// sLBP-(N|A|S)LRFn: columns nearer than 1 m, nearer than 2 m, the rest.
class DepthLbp : public Descriptor {
 public:
  DepthLbp(char kind, int columns, const DescriptorParams& p)
      : kind_(kind),
        columns_(columns),
        params_(p),
        engine_(p.lbp, {8, p.value_min, p.saturation_min}, p.threads) {}

  int size() const override {
    return 3 * kPart + (kind_ == 'A' ? kPart : kind_ == 'S' ? kUniformLabels : 0);
  }

  void compute(const cv::Mat& image, const Readings& readings, float* out) override {
    requireColor(image, "sLBP");
    if (readings.ranges.empty()) {
      throw std::invalid_argument("sLBP needs distances across the image, but there are none");
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
    for (int i = 0; i < 3 * 8; ++i) {
      const std::uint32_t* counts =
          engine_.counts().data() + static_cast<std::size_t>(i) * kLbpCodes;
      fold(counts, true, scale, out + i * kUniformLabels);
      if (kind_ == 'A') fold(counts, true, scale, out + 3 * kPart + i % 8 * kUniformLabels);
      if (kind_ == 'S') fold(counts, true, scale, out + 3 * kPart);
    }
  }

  /// Mean of the finite distances in each of n equal groups; infinity where there is none.
  static void meanRanges(const std::vector<float>& ranges, int n, std::vector<float>& means) {
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

 private:
  static constexpr int kPart = 8 * kUniformLabels;
  char kind_;
  int columns_;
  DescriptorParams params_;
  ColorLbp engine_;
  Layout layout_;
  std::vector<float> means_;
  std::vector<int> regions_;
};

constexpr int kScanBins = 61;
constexpr float kScanWeight = 2.0f;

/// psi, [psi], An, scan.
class ReadingsTerm : public Descriptor {
 public:
  ReadingsTerm(char kind, int n, const DescriptorParams& p) : kind_(kind), n_(n), params_(p) {}
  int size() const override { return kind_ == 'A' || kind_ == 's' ? n_ : kind_ == 'm' ? 4 : 1; }
  void compute(const cv::Mat&, const Readings& r, float* out) override {
    if (kind_ == 'p') {
      if (!std::isfinite(r.heading)) missing("a heading");
      const double turns = r.heading / (2.0 * 3.14159265358979323846);
      out[0] = static_cast<float>(params_.heading_weight * (turns - std::floor(turns)));
    } else if (kind_ == 'm') {
      double square = 0.0;
      for (int i = 0; i < 3; ++i) {
        if (!std::isfinite(r.magnetic[i])) missing("a magnetic field");
        out[i] = static_cast<float>(params_.heading_weight * r.magnetic[i]);
        square += r.magnetic[i] * r.magnetic[i];
      }
      out[3] = static_cast<float>(params_.heading_weight * std::sqrt(square));
    } else {
      const std::vector<float>& source = kind_ == 'A' ? r.ranges : r.scan;
      if (source.empty()) missing(kind_ == 'A' ? "distances across the image" : "a laser scan");
      DepthLbp::meanRanges(source, n_, means_);
      const float max = static_cast<float>(params_.range_max);
      for (int i = 0; i < n_; ++i) {
        const float d = std::min(means_[i], max) / max;
        // Squared distances of scans then count half as much as those of LGOP.
        out[i] = static_cast<float>(params_.range_weight) *
                 (kind_ == 's' ? kScanWeight * d / kScanBins : d);
      }
    }
  }

 private:
  [[noreturn]] static void missing(const std::string& what) {
    throw std::invalid_argument("the descriptor needs " + what + ", but there is none");
  }
  char kind_;
  int n_;
  DescriptorParams params_;
  std::vector<float> means_;
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
  if (ends("-IRIS-VP"))
    v.regions = Regions::kIrisVanishing;
  else if (ends("-IRIS"))
    v.regions = Regions::kIris;
  else if (ends("-D"))
    v.regions = Regions::kHalves;
  if (rest.size() < 3 || (rest.front() != 'U' && rest.front() != 'S') ||
      std::string("NUS").find(rest.back()) == std::string::npos) {
    return nullptr;
  }
  v.uniform = rest.front() == 'U';
  v.second = rest.back();
  v.colors = numberAfter(rest.substr(0, rest.size() - 1), rest.substr(0, 1), 3, 16);
  if (v.colors < 0) return nullptr;
  if (!v.uniform && v.second != 'N') {
    throw std::invalid_argument("descriptor '" + name +
                                "': a second stage needs the uniform first stage (U)");
  }
  return std::make_unique<LbpByHsv>(v, params);
}

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

DescriptorPtr makeReadingsTerm(const std::string& name, const DescriptorParams& params) {
  if (name == "psi") return std::make_unique<ReadingsTerm>('p', 1, params);
  if (name == "[psi]") return std::make_unique<ReadingsTerm>('m', 4, params);
  if (name == "scan") return std::make_unique<ReadingsTerm>('s', kScanBins, params);
  const int n = numberAfter(name, "A", 1, 1000);
  return n > 0 ? std::make_unique<ReadingsTerm>('A', n, params) : nullptr;
}

std::vector<float> rangesOfDepth(const cv::Mat& depth, int n) {
  if (depth.empty() || depth.type() != CV_16UC1) {
    throw std::invalid_argument("a depth image must have one channel of 16 bits");
  }
  if (n < 1 || n > depth.cols) {
    throw std::invalid_argument("the depth image has too few columns for " + std::to_string(n));
  }
  // Half of the rows, about the middle: neither the floor nor the ceiling near the robot.
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

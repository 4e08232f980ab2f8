// Sensor readings beside the image: psi, [psi], An and scan (dos Santos 2014, 6.3.2 and 7.3.2).
#include <algorithm>
#include <cmath>

#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr int kScanBins = 61;
// With this weight squared distances of scans count half as much as those of LGOP.
constexpr float kScanWeight = 2.0f;

enum class Reading { kHeading, kMagneticField, kRanges, kScan };

class SensorReadingsTerm : public Descriptor {
 public:
  SensorReadingsTerm(Reading kind, int bins, const DescriptorParams& params)
      : kind_(kind), bins_(bins), params_(params) {}

  int size() const override { return bins_; }

  RequiredReadings requiredReadings() const override {
    RequiredReadings required;
    required.heading = kind_ == Reading::kHeading;
    required.magnetic = kind_ == Reading::kMagneticField;
    required.ranges = kind_ == Reading::kRanges;
    required.scan = kind_ == Reading::kScan;
    return required;
  }

  void compute(const cv::Mat&, const SensorReadings& readings, float* out) override {
    switch (kind_) {
      case Reading::kHeading:
        return computeHeading(readings, out);
      case Reading::kMagneticField:
        return computeMagneticField(readings, out);
      case Reading::kRanges:
        return computeRanges(readings.ranges, "distances across the image", out);
      case Reading::kScan:
        return computeRanges(readings.scan, "a laser scan", out);
    }
  }

 private:
  void computeHeading(const SensorReadings& readings, float* out) const {
    if (!std::isfinite(readings.heading)) throwMissing("a heading");
    const double turns = readings.heading / (2.0 * hyselam::kPi);
    out[0] = static_cast<float>(params_.heading_weight * (turns - std::floor(turns)));
  }

  void computeMagneticField(const SensorReadings& readings, float* out) const {
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double component = readings.magnetic[static_cast<std::size_t>(i)];
      if (!std::isfinite(component)) throwMissing("a magnetic field");
      out[i] = static_cast<float>(params_.heading_weight * component);
      square += component * component;
    }
    out[3] = static_cast<float>(params_.heading_weight * std::sqrt(square));
  }

  void computeRanges(const std::vector<float>& ranges, const char* what, float* out) {
    if (ranges.empty()) throwMissing(what);
    meanRanges(ranges, bins_, means_);
    const float max = static_cast<float>(params_.range_max);
    for (int i = 0; i < bins_; ++i) {
      const float d = std::min(means_[static_cast<std::size_t>(i)], max) / max;
      out[i] = static_cast<float>(params_.range_weight) *
               (kind_ == Reading::kScan ? kScanWeight * d / kScanBins : d);
    }
  }

  [[noreturn]] static void throwMissing(const std::string& what) {
    throw hyselam::InputError("descriptor", "", "needs " + what + ", but there is none");
  }

  Reading kind_;
  int bins_;
  DescriptorParams params_;
  std::vector<float> means_;
};

}  // namespace

DescriptorPtr makeSensorReadingsTerm(const std::string& name, const DescriptorParams& params) {
  const auto make = [&](Reading kind, int bins) {
    return std::make_unique<SensorReadingsTerm>(kind, bins, params);
  };
  if (name == "psi") return make(Reading::kHeading, 1);
  if (name == "[psi]") return make(Reading::kMagneticField, 4);
  if (name == "scan") return make(Reading::kScan, kScanBins);
  const int n = numberAfter(name, "A", 1, 1000);
  return n > 0 ? make(Reading::kRanges, n) : nullptr;
}

}  // namespace selovis

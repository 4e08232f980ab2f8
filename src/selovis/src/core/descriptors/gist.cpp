// HSV-GIST: the spatial envelope (Oliva, Torralba 2001) of each HSV channel of a small square
// image.
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"
#include "selovis/descriptors/color_lbp.hpp"

namespace selovis {
namespace {

constexpr int kOrientations[3] = {8, 8, 4};  // of the scales from fine to coarse
constexpr int kFilters = 20, kBlocks = 4, kPerChannel = kFilters * kBlocks * kBlocks;
using hyselam::kPi;

class Gist : public Descriptor {
 public:
  /// Of the three HSV channels, or of saturation and brightness alone.
  Gist(int side, bool without_hue, float weight)
      : side_(side), without_hue_(without_hue), weight_(weight) {
    int index = 0;
    for (int scale = 0; scale < 3; ++scale) {
      for (int o = 0; o < kOrientations[scale]; ++o, ++index) {
        filters_.push_back(transferFunction(scale, o, kOrientations[scale]));
      }
    }
    // Low-pass of the local contrast normalisation: 4 cycles per image.
    low_pass_.create(side, side, CV_32F);
    const double s1 = 4.0 / std::sqrt(std::log(2.0));
    for (int v = 0; v < side; ++v) {
      for (int u = 0; u < side; ++u) {
        const double fx = frequency(u), fy = frequency(v);
        low_pass_.at<float>(v, u) = static_cast<float>(std::exp(-(fx * fx + fy * fy) / (s1 * s1)));
      }
    }
  }

  int size() const override { return (without_hue_ ? 2 : 3) * kPerChannel; }

  std::vector<SignaturePart> parts() const override {
    if (without_hue_) return {{"SV-GIST", size(), 0.5}};
    return {{"H-GIST", kPerChannel, 0.5, true}, {"SV-GIST", 2 * kPerChannel, 0.5}};
  }

  void compute(const cv::Mat& image, const SensorReadings&, float* out) override {
    requireColor(image, without_hue_ ? "SV-GIST" : "HSV-GIST");
    cv::resize(image, small_, cv::Size(side_, side_), 0.0, 0.0, cv::INTER_AREA);
    cv::cvtColor(small_, hsv_, cv::COLOR_BGR2HSV);
    for (int c = without_hue_ ? 1 : 0; c < 3; ++c) {
      cv::extractChannel(hsv_, channel_, c);
      channel_.convertTo(plane_, CV_32F, c == 0 ? 1.0 / 180.0 : 1.0 / 255.0);
      normalize();
      cv::dft(plane_, spectrum_, cv::DFT_COMPLEX_OUTPUT);
      for (int f = 0; f < kFilters; ++f) {
        multiply(filters_[static_cast<std::size_t>(f)]);
        cv::dft(product_, response_, cv::DFT_INVERSE | cv::DFT_SCALE);
        pool(out + f * kBlocks * kBlocks);
      }
      out += kPerChannel;
    }
  }

 private:
  double frequency(int i) const { return i < (side_ + 1) / 2 ? i : i - side_; }

  cv::Mat transferFunction(int scale, int orientation, int orientations) const {
    cv::Mat filter(side_, side_, CV_32F);
    const double radial = 0.35, center = 0.3 / std::pow(1.85, scale),
                 angular = 16.0 * orientations * orientations / 1024.0,
                 direction = kPi / orientations * orientation;
    for (int v = 0; v < side_; ++v) {
      for (int u = 0; u < side_; ++u) {
        const double fx = frequency(u), fy = frequency(v);
        double angle = std::atan2(fy, fx) + direction;
        angle -= 2.0 * kPi * std::round(angle / (2.0 * kPi));
        const double r = std::hypot(fx, fy) / side_ / center - 1.0;
        filter.at<float>(v, u) = static_cast<float>(
            std::exp(-10.0 * radial * r * r - 2.0 * angular * kPi * angle * angle));
      }
    }
    return filter;
  }

  void multiply(const cv::Mat& filter) {
    product_.create(side_, side_, CV_32FC2);
    for (int v = 0; v < side_; ++v) {
      const cv::Vec2f* in = spectrum_.ptr<cv::Vec2f>(v);
      const float* weight = filter.ptr<float>(v);
      cv::Vec2f* row = product_.ptr<cv::Vec2f>(v);
      for (int u = 0; u < side_; ++u) row[u] = in[u] * weight[u];
    }
  }

  /// plane := (plane - its low-pass) / (0.2 + local deviation)
  void normalize() {
    const auto smooth = [&](const cv::Mat& from, cv::Mat& to) {
      cv::dft(from, spectrum_, cv::DFT_COMPLEX_OUTPUT);
      multiply(low_pass_);
      cv::dft(product_, to, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
    };
    smooth(plane_, smooth_);
    plane_ -= smooth_;
    cv::multiply(plane_, plane_, square_);
    smooth(square_, smooth_);
    cv::max(smooth_, 0.0, smooth_);
    cv::sqrt(smooth_, smooth_);
    smooth_ += 0.2;
    cv::divide(plane_, smooth_, plane_);
  }

  /// Mean magnitude of the responses in each block.
  void pool(float* out) const {
    const int block = side_ / kBlocks;
    for (int b = 0; b < kBlocks * kBlocks; ++b) {
      cv::v_float32x4 sums = cv::v_setzero_f32();
      float rest = 0.0f;
      for (int v = b / kBlocks * block; v < (b / kBlocks + 1) * block; ++v) {
        const float* row = response_.ptr<float>(v) + 2 * (b % kBlocks * block);
        int u = 0;
        for (; u + 4 <= block; u += 4) {
          cv::v_float32x4 real, imaginary;
          cv::v_load_deinterleave(row + 2 * u, real, imaginary);
          sums += cv::v_sqrt(cv::v_muladd(real, real, imaginary * imaginary));
        }
        for (; u < block; ++u) {
          rest += std::sqrt(row[2 * u] * row[2 * u] + row[2 * u + 1] * row[2 * u + 1]);
        }
      }
      out[b] = weight_ * (cv::v_reduce_sum(sums) + rest) / static_cast<float>(block * block);
    }
  }

  int side_;
  bool without_hue_;
  float weight_;
  std::vector<cv::Mat> filters_;
  cv::Mat low_pass_, small_, hsv_, channel_, plane_, spectrum_, product_, response_, smooth_,
      square_;
};

}  // namespace

DescriptorPtr makeGist(const std::string& name, const DescriptorParams& /*params*/) {
  if (name == "HSV-GIST") return std::make_unique<Gist>(32, false, 1.0f);
  if (name == "SV-GIST") return std::make_unique<Gist>(32, true, 1.0f);
  const int side = numberAfter(name, "HSV-GIST", 8, 256);
  if (side > 0 && side % kBlocks != 0) {
    throw hyselam::InputError("descriptor '" + name + "'", "", "the side must be a multiple of 4");
  }
  return side > 0 ? std::make_unique<Gist>(side, false, 1.0f) : nullptr;
}

DescriptorPtr makeSaturationValueGist(float weight) {
  return std::make_unique<Gist>(32, true, weight);
}

}  // namespace selovis

#include "sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace hyselam_sim {
namespace {

// In (-1, 1), mean 0, standard deviation 0.41: two bytes of a hash.
float triangular(std::uint64_t bits, int at) {
  const auto a = static_cast<float>((bits >> (16 * at)) & 0xffu);
  const auto b = static_cast<float>((bits >> (16 * at + 8)) & 0xffu);
  return (a - b) * (1.0f / 255.0f);
}

}  // namespace

cv::Mat develop(const CameraParams& params, const cv::Mat& light, std::uint64_t seed) {
  const cv::Scalar mean = cv::mean(light);
  const double luminance = std::max(1e-6, 0.114 * mean[0] + 0.587 * mean[1] + 0.299 * mean[2]);
  constexpr double kTarget = 0.24, kUsual = 0.3;
  const double gain = kTarget / kUsual * std::pow(kUsual / luminance, params.exposure);
  std::array<float, 3> gains{};
  for (int c = 0; c < 3; ++c) {
    const double gray = luminance / std::max(1e-6, mean[c]);
    gains[static_cast<std::size_t>(c)] =
        static_cast<float>(gain * std::pow(std::clamp(gray, 0.3, 3.0), params.white_balance));
  }
  // Dark pictures are noisier; 2.45 makes the draws' standard deviation 1.
  const auto noise = static_cast<float>(2.45 * params.noise * std::clamp(gain / 4.0, 0.15, 1.5));
  std::array<std::uint8_t, 4097> gamma{};
  for (std::size_t i = 0; i < gamma.size(); ++i) {
    const double x = static_cast<double>(i) / 4096.0;
    gamma[i] = static_cast<std::uint8_t>(std::lround(255.0 * std::pow(x, 1.0 / 2.2)));
  }
  cv::Mat out(light.size(), CV_8UC3);
  for (int v = 0; v < light.rows; ++v) {
    const auto* in = light.ptr<cv::Vec3f>(v);
    auto* bytes = out.ptr<cv::Vec3b>(v);
    for (int u = 0; u < light.cols; ++u) {
      const std::uint64_t bits =
          hyselam::mix(seed, static_cast<std::uint64_t>(v) * 65536u + static_cast<unsigned>(u));
      for (int c = 0; c < 3; ++c) {
        float x = in[u][c] * gains[static_cast<std::size_t>(c)];
        x = x / (1.0f + 0.25f * x) * 1.12f;  // highlights bend instead of clipping
        x += noise * std::sqrt(x + 0.02f) * triangular(bits, c);
        bytes[u][c] = gamma[static_cast<std::size_t>(std::clamp(x, 0.0f, 1.0f) * 4096.0f)];
      }
    }
  }
  return out;
}

cv::Mat measureDepth(const CameraParams& params, const cv::Mat& depth, std::uint64_t seed) {
  cv::Mat out(depth.size(), CV_16UC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const float d = depth.at<float>(v, u);
      const std::uint64_t bits =
          hyselam::mix(seed, static_cast<std::uint64_t>(v) * 65536u + static_cast<unsigned>(u));
      const float measured =
          d + 2.45f * static_cast<float>(params.depth_sigma) * d * d * triangular(bits, 3);
      const bool seen = measured >= static_cast<float>(params.depth_min) &&
                        measured <= static_cast<float>(params.depth_max);
      out.at<std::uint16_t>(v, u) =
          seen ? static_cast<std::uint16_t>(std::lround(1000.0f * measured)) : std::uint16_t{0};
    }
  }
  return out;
}

}  // namespace hyselam_sim

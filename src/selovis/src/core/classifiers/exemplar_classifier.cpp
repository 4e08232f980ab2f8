#include "exemplar_classifier.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core/hal/intrin.hpp>

namespace selovis {
namespace {

// The typical distance between training signatures: the median over about so many of the samples of
// the distance to the nearest sample that is at least so many frames away in time.
constexpr std::size_t kTypicalSamples = 200;
constexpr int kApartInTime = 20;  // [frames]

constexpr double kMinSquaredDistance = 1e-9;  // against division by 0: an image that was learned
constexpr double kMinProbability = 1e-3;      // no single frame rules a place out

}  // namespace

float dot(const float* a, const float* b, std::size_t n) {
  cv::v_float32x4 s0 = cv::v_setzero_f32(), s1 = s0, s2 = s0, s3 = s0;
  std::size_t i = 0;
  for (; i + 16 <= n; i += 16) {
    s0 = cv::v_muladd(cv::v_load(a + i), cv::v_load(b + i), s0);
    s1 = cv::v_muladd(cv::v_load(a + i + 4), cv::v_load(b + i + 4), s1);
    s2 = cv::v_muladd(cv::v_load(a + i + 8), cv::v_load(b + i + 8), s2);
    s3 = cv::v_muladd(cv::v_load(a + i + 12), cv::v_load(b + i + 12), s3);
  }
  float sum = cv::v_reduce_sum((s0 + s1) + (s2 + s3));
  for (; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

void normalizeSignature(const float* in, std::size_t size, double power, double scale, float* out) {
  const float factor = static_cast<float>(scale);
  if (power == 1.0) {
    for (std::size_t i = 0; i < size; ++i) out[i] = factor * in[i];
  } else if (power == 0.5) {
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = std::copysign(factor * std::sqrt(std::abs(in[i])), in[i]);
    }
  } else {
    const float exponent = static_cast<float>(power);
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = std::copysign(factor * std::pow(std::abs(in[i]), exponent), in[i]);
    }
  }
}

double normalizationScale(const Samples& samples, double power) {
  std::vector<float> row(samples.size);
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.count(); ++i) {
    normalizeSignature(samples.row(i), samples.size, power, 1.0, row.data());
    sum += dot(row.data(), row.data(), samples.size);
  }
  return sum > 0.0 ? 1.0 / std::sqrt(sum / static_cast<double>(samples.count())) : 1.0;
}

ExemplarClassifier::ExemplarClassifier(const Samples& samples, int places,
                                       const ClassifierParams& params)
    : places_(places),
      params_(params),
      scale_(normalizationScale(samples, params.power)),
      size_(samples.size),
      rows_(samples.values.size()),
      squares_(samples.count()),
      query_(samples.size),
      distances_(samples.count()),
      labels_(samples.places),
      order_(samples.count()) {
  for (std::size_t i = 0; i < samples.count(); ++i) {
    float* row = rows_.data() + i * size_;
    normalizeSignature(samples.row(i), size_, params.power, scale_, row);
    squares_[i] = dot(row, row, size_);
  }
  typical_distance_ = typicalDistance(samples);
}

double ExemplarClassifier::typicalDistance(const Samples& samples) const {
  std::vector<double> nearest;
  const std::size_t step = std::max<std::size_t>(1, samples.count() / kTypicalSamples);
  for (std::size_t i = 0; i < samples.count(); i += step) {
    double best = -1.0;
    for (std::size_t j = 0; j < samples.count(); ++j) {
      if (std::abs(samples.frames[i] - samples.frames[j]) < kApartInTime) continue;
      const double d = squares_[i] + squares_[j] -
                       2.0 * dot(rows_.data() + i * size_, rows_.data() + j * size_, size_);
      if (best < 0.0 || d < best) best = d;
    }
    if (best >= 0.0) nearest.push_back(best);
  }
  if (nearest.empty()) return 1.0;
  std::nth_element(nearest.begin(),
                   nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2),
                   nearest.end());
  return std::sqrt(std::max(1e-12, nearest[nearest.size() / 2]));
}

void ExemplarClassifier::predict(const float* signature, double* probabilities) {
  normalizeSignature(signature, size_, params_.power, scale_, query_.data());
  const float square = dot(query_.data(), query_.data(), size_);
  const std::size_t n = labels_.size();
  for (std::size_t i = 0; i < n; ++i) {
    distances_[i] = std::max(
        0.0f, square + squares_[i] - 2.0f * dot(query_.data(), rows_.data() + i * size_, size_));
  }
  const std::size_t k = std::min(n, static_cast<std::size_t>(params_.neighbors));
  std::iota(order_.begin(), order_.end(), 0);
  const auto nearer = [&](int a, int b) {
    return distances_[a] != distances_[b] ? distances_[a] < distances_[b] : a < b;
  };
  std::nth_element(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(k - 1),
                   order_.end(), nearer);
  std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(k), nearer);
  const double nearest = std::max(kMinSquaredDistance, static_cast<double>(distances_[order_[0]]));
  novelty_ = std::sqrt(nearest) / typical_distance_;
  std::fill(probabilities, probabilities + places_, 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < k; ++i) {
    const double w = std::exp(-params_.beta * (distances_[order_[i]] - nearest) / nearest);
    probabilities[labels_[order_[i]]] += w;
    sum += w;
  }
  for (int c = 0; c < places_; ++c) {
    probabilities[c] =
        (probabilities[c] / sum + kMinProbability) / (1.0 + kMinProbability * places_);
  }
}

}  // namespace selovis

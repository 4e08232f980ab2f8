#include "part_exemplars.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core/hal/intrin.hpp>

#include "exemplar_classifier.hpp"
#include "hyselam_common/rng.hpp"

namespace selovis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

constexpr float kUnit = 8192.0f;  // of the 16-bit rows, whose mean squared length is 1
constexpr double kMaxScale = 1e12;
constexpr std::size_t kLane = 8;             // rows are filled up with zeros to multiples of it
constexpr std::size_t kComponents = 32;      // principal components
constexpr std::size_t kComponentRows = 400;  // that they are learned from, at most
constexpr int kIterations = 4;               // of the subspace
constexpr std::size_t kCompared = 80;        // frames whose views are compared exactly
constexpr std::size_t kNeighbors = 200;      // views that are answered
constexpr std::size_t kSampled = 16;         // of so many frames one tells what is near

/// Dot product of two rows of 16-bit integers; n is a multiple of kLane.
float dot16(const std::int16_t* a, const std::int16_t* b, std::size_t n) {
  cv::v_float32x4 sum = cv::v_setzero_f32();
  for (std::size_t i = 0; i < n; i += kLane) {
    sum += cv::v_cvt_f32(cv::v_dotprod(cv::v_load(a + i), cv::v_load(b + i)));
  }
  return cv::v_reduce_sum(sum) / (kUnit * kUnit);
}

}  // namespace

FrameIndex::FrameIndex(const Samples& samples) {
  for (std::size_t i = 0; i < samples.count(); ++i) {
    if (i == 0 || samples.frames[i] != samples.frames[i - 1]) {
      begin.push_back(static_cast<std::uint32_t>(i));
    }
  }
  begin.push_back(static_cast<std::uint32_t>(samples.count()));
}

PartExemplars::PartExemplars(const Samples& samples, const FrameIndex& frames, std::size_t offset,
                             const SignaturePart& part, bool full_scan)
    : frames_(&frames),
      size_(static_cast<std::size_t>(part.size)),
      padded_((size_ + kLane - 1) / kLane * kLane),
      power_(part.power),
      scale_(1.0),
      buffer_(size_),
      centered_(padded_),
      rows_(samples.count() * padded_, 0),
      query_(padded_, 0),
      squares_(samples.count()),
      frame_distances_(frames.count()),
      order_(frames.count()) {
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.count(); ++i) {
    normalizeSignature(samples.row(i) + offset, size_, power_, 1.0, buffer_.data());
    sum += dot(buffer_.data(), buffer_.data(), size_);
  }
  // At most kMaxScale: values that are as good as 0 stay so.
  if (sum > 0.0) {
    scale_ = std::min(kMaxScale, 1.0 / std::sqrt(sum / static_cast<double>(samples.count())));
  }
  for (std::size_t i = 0; i < samples.count(); ++i) {
    quantize(samples.row(i) + offset, rows_.data() + i * padded_);
    squares_[i] = dot16(rows_.data() + i * padded_, rows_.data() + i * padded_, padded_);
  }
  if (!full_scan && frames.count() > 2 * kCompared && size_ > kComponents) learnComponents();
}

void PartExemplars::quantize(const float* part, std::int16_t* out) {
  normalizeSignature(part, size_, power_, scale_, buffer_.data());
  for (std::size_t i = 0; i < size_; ++i) {
    out[i] =
        static_cast<std::int16_t>(std::lround(std::clamp(kUnit * buffer_[i], -32767.0f, 32767.0f)));
  }
}

float PartExemplars::distanceTo(std::uint32_t sample) const {
  return std::max(0.0f, query_square_ + squares_[sample] -
                            2.0f * dot16(query_.data(), rows_.data() + sample * padded_, padded_));
}

// Orthogonal iteration: the components span what the covariance of the rows stretches most.
void PartExemplars::learnComponents() {
  const std::size_t frames = frames_->count(),
                    step = (frames + kComponentRows - 1) / kComponentRows;
  std::vector<std::size_t> chosen;
  for (std::size_t f = 0; f < frames; f += step) chosen.push_back(frames_->begin[f]);
  mean_.assign(padded_, 0.0f);
  for (const std::size_t i : chosen) {
    for (std::size_t k = 0; k < size_; ++k) {
      mean_[k] += static_cast<float>(rows_[i * padded_ + k]) / (kUnit * chosen.size());
    }
  }
  std::vector<float> centered(chosen.size() * padded_, 0.0f);
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    for (std::size_t k = 0; k < size_; ++k) {
      centered[c * padded_ + k] =
          static_cast<float>(rows_[chosen[c] * padded_ + k]) / kUnit - mean_[k];
    }
  }
  hyselam::Rng rng(1);
  components_.assign(kComponents * padded_, 0.0f);
  for (std::size_t j = 0; j < kComponents; ++j) {
    for (std::size_t k = 0; k < size_; ++k) {
      components_[j * padded_ + k] = static_cast<float>(rng.gaussian());
    }
  }
  std::vector<float> next(components_.size());
  for (int round = 0; round <= kIterations; ++round) {
    for (std::size_t j = 0; j < kComponents; ++j) {  // Gram-Schmidt
      float* v = components_.data() + j * padded_;
      for (std::size_t i = 0; i < j; ++i) {
        const float* u = components_.data() + i * padded_;
        const float along = dot(u, v, padded_);
        for (std::size_t k = 0; k < padded_; ++k) v[k] -= along * u[k];
      }
      const float length = std::sqrt(dot(v, v, padded_));
      const float factor = length > 1e-12f ? 1.0f / length : 0.0f;
      for (std::size_t k = 0; k < padded_; ++k) v[k] *= factor;
    }
    if (round == kIterations) break;
    std::fill(next.begin(), next.end(), 0.0f);
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      const float* row = centered.data() + c * padded_;
      for (std::size_t j = 0; j < kComponents; ++j) {
        const float along = dot(row, components_.data() + j * padded_, padded_);
        float* out = next.data() + j * padded_;
        for (std::size_t k = 0; k < padded_; ++k) out[k] += along * row[k];
      }
    }
    components_.swap(next);
  }
  codes_.resize(frames * kComponents);
  residues_.resize(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    project(rows_.data() + frames_->begin[f] * padded_, codes_.data() + f * kComponents,
            residues_.data() + f);
  }
}

void PartExemplars::project(const std::int16_t* row, float* out, float* residue) {
  for (std::size_t k = 0; k < padded_; ++k) {
    centered_[k] = static_cast<float>(row[k]) / kUnit - mean_[k];
  }
  float rest = dot(centered_.data(), centered_.data(), padded_);
  for (std::size_t j = 0; j < kComponents; ++j) {
    out[j] = dot(centered_.data(), components_.data() + j * padded_, padded_);
    rest -= out[j] * out[j];
  }
  *residue = std::max(0.0f, rest);
}

/// What is outside of the components is taken to be at right angles.
void PartExemplars::estimate() {
  std::array<float, kComponents> code;
  float residue = 0.0f;
  project(query_.data(), code.data(), &residue);
  const float* row = codes_.data();
  for (std::size_t f = 0; f < frame_distances_.size(); ++f, row += kComponents) {
    cv::v_float32x4 sum = cv::v_setzero_f32();
    for (std::size_t j = 0; j < kComponents; j += 4) {
      const cv::v_float32x4 d = cv::v_load(code.data() + j) - cv::v_load(row + j);
      sum = cv::v_muladd(d, d, sum);
    }
    frame_distances_[f] = cv::v_reduce_sum(sum) + residue + residues_[f];
  }
}

/// Of order_ the nearest by the estimate, of equal ones the first, in their order.
void PartExemplars::keepNearest() {
  // Nearly all are farther than a limit that a sample suggests; whether it was too tight is seen.
  few_.clear();
  for (std::size_t i = 0; i < order_.size(); i += kSampled) {
    few_.push_back(frame_distances_[order_[i]]);
  }
  const std::size_t rank = 2 * kCompared / kSampled + 2;
  float limit = kInfinity;
  if (rank < few_.size()) {
    std::nth_element(few_.begin(), few_.begin() + rank, few_.end());
    limit = few_[rank];
  }
  const auto collect = [&] {
    few_.clear();
    for (const std::uint32_t f : order_) {
      if (frame_distances_[f] <= limit) few_.push_back(frame_distances_[f]);
    }
  };
  collect();
  if (few_.size() < kCompared) {
    limit = kInfinity;
    collect();
  }
  std::nth_element(few_.begin(), few_.begin() + (kCompared - 1), few_.end());
  limit = few_[kCompared - 1];
  std::size_t equal = kCompared;
  for (std::size_t i = 0; i < kCompared; ++i) equal -= few_[i] < limit;
  std::size_t kept = 0;
  for (const std::uint32_t f : order_) {
    const float d = frame_distances_[f];
    if (d > limit || (d == limit && equal == 0)) continue;
    equal -= d == limit;
    order_[kept++] = f;
  }
  order_.resize(kept);
}

const std::vector<Neighbor>& PartExemplars::search(const float* part,
                                                   const std::vector<char>* blocked) {
  quantize(part, query_.data());
  query_square_ = dot16(query_.data(), query_.data(), padded_);
  const bool indexed = !codes_.empty();
  if (indexed) estimate();
  order_.clear();
  for (std::uint32_t f = 0; f < frame_distances_.size(); ++f) {
    if (blocked != nullptr && (*blocked)[f] != 0) {
      frame_distances_[f] = kInfinity;
    } else {
      order_.push_back(f);
    }
  }
  if (indexed && order_.size() > kCompared) keepNearest();
  compared_.clear();
  for (const std::uint32_t f : order_) {
    for (std::uint32_t i = frames_->begin[f]; i < frames_->begin[f + 1]; ++i) {
      compared_.push_back({distanceTo(i), i});
    }
  }
  nearest_.resize(std::min(kNeighbors, compared_.size()));
  std::partial_sort_copy(compared_.begin(), compared_.end(), nearest_.begin(), nearest_.end(),
                         [](const Neighbor& a, const Neighbor& b) {
                           return a.distance != b.distance ? a.distance < b.distance
                                                           : a.sample < b.sample;
                         });
  return nearest_;
}

}  // namespace selovis

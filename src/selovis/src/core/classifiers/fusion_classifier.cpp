#include "fusion_classifier.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

// Probability that is left to all places alike: no single frame rules one out.
constexpr double kUnsaid = 0.01;
constexpr float kFar = 1.0f;  // relative squared distance from which a view is far
// Chosen with the default PoseFilterParams::similarity_beta between the house's tours by lamplight
// and on two simulated floors.
constexpr float kViewScale = 5.3f;
constexpr double kMinSquaredDistance = 1e-6;

}  // namespace

FusionClassifier::FusionClassifier(const Samples& samples, int places,
                                   const ClassifierParams& params)
    : places_(places),
      params_(params),
      parts_(samples.parts),
      labels_(samples.places),
      frames_(samples) {
  index(samples, false);
  calibration_ = calibrateFusion(samples, places, params.beta, frames_, exemplars_);
}

FusionClassifier::FusionClassifier(const Samples& samples, int places,
                                   const ClassifierParams& params, const std::string& state,
                                   bool full_scan)
    : places_(places),
      params_(params),
      parts_(samples.parts),
      labels_(samples.places),
      frames_(samples) {
  index(samples, full_scan);
  calibration_ = fusionCalibrationFromText(state, parts_);
}

void FusionClassifier::index(const Samples& samples, bool full_scan) {
  std::size_t offset = 0;
  exemplars_.reserve(parts_.size());
  for (const SignaturePart& part : parts_) {
    exemplars_.emplace_back(samples, frames_, offset, part, full_scan);
    offset += static_cast<std::size_t>(part.size);
    opinions_.push_back({part.name, -1, 0.0, 0.0, false, part.absolute_color});
  }
  if (offset != samples.size) {
    throw hyselam::InputError("kernel 'fusion'", "", "the parts of the signatures are not known");
  }
  sum_.resize(static_cast<std::size_t>(places_));
  log_likelihoods_.resize(sum_.size());
  nearest_.resize(parts_.size());
  shares_.resize(parts_.size());
  weights_.resize(parts_.size());
}

void FusionClassifier::predict(const float* signature, double* probabilities) {
  std::fill(sum_.begin(), sum_.end(), 0.0);
  distances_known_ = false;
  const float* part = signature;
  for (std::size_t p = 0; p < parts_.size(); part += parts_[p].size, ++p) {
    nearest_[p] = exemplars_[p].search(part).front().distance;
  }
  weightsAt(calibration_, nearest_, weights_);
  shareByRange(calibration_, parts_, nearest_, shares_);
  novelty_ = 0.0;
  double asked = 0.0, weights = 0.0, far_weights = 0.0;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    placeLogLikelihoods(exemplars_[p].nearest(), labels_, params_.beta, log_likelihoods_);
    const PartCalibration& c = calibration_.parts[p];
    const double weight = weights_[p] * shares_[p];
    const auto best = std::max_element(log_likelihoods_.begin(), log_likelihoods_.end());
    opinions_[p].place = static_cast<int>(best - log_likelihoods_.begin());
    opinions_[p].probability = std::exp(*best);
    opinions_[p].weight = weight;
    opinions_[p].out_of_range = rangeShare(c, nearest_[p]) <= 0.0;
    asked += weight;
    weights += weights_[p];
    far_weights += c.weight;
    if (c.median > 0.0) novelty_ += c.weight * std::sqrt(nearest_[p] / c.median);
    for (std::size_t k = 0; k < sum_.size(); ++k) sum_[k] += weight * log_likelihoods_[k];
  }
  novelty_ /= std::max(far_weights, 1e-12);
  for (PartOpinion& opinion : opinions_) opinion.weight /= std::max(asked, 1e-12);
  const double sharpness = evidenceScale(weights, asked) / calibration_.temperature;
  const double most = *std::max_element(sum_.begin(), sum_.end());
  double total = 0.0;
  for (std::size_t k = 0; k < sum_.size(); ++k) {
    probabilities[k] = std::exp(sharpness * (sum_[k] - most));
    total += probabilities[k];
  }
  for (std::size_t k = 0; k < sum_.size(); ++k) {
    probabilities[k] =
        (1.0 - kUnsaid) * probabilities[k] / total + kUnsaid / static_cast<double>(places_);
  }
}

const std::vector<float>* FusionClassifier::distances() const {
  if (distances_known_) return &distances_;
  distances_known_ = true;
  distances_.assign(labels_.size(), 1.0f);
  part_distances_.resize(labels_.size());
  // All views of a frame are as far off as the frame, unless some part has compared them.
  compared_.assign(frames_.count(), 0);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (opinions_[p].weight <= 0.0) continue;
    for (const std::uint32_t f : exemplars_[p].comparedFrames()) compared_[f] = 1;
  }
  compared_frames_.clear();
  for (std::uint32_t f = 0; f < compared_.size(); ++f) {
    if (compared_[f] != 0) compared_frames_.push_back(f);
  }
  frame_sums_.assign(frames_.count(), 1.0f);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const float weight = static_cast<float>(opinions_[p].weight);
    if (weight <= 0.0f) continue;
    const float nearest = static_cast<float>(std::max(kMinSquaredDistance, nearest_[p]));
    const auto far = [&](float distance) {
      return kViewScale * weight * std::clamp((distance - nearest) / nearest, 0.0f, kFar);
    };
    const std::vector<float>& of_frames = exemplars_[p].frameDistances();
    for (std::size_t f = 0; f < frame_sums_.size(); ++f) frame_sums_[f] += far(of_frames[f]);
    for (const std::uint32_t f : compared_frames_) {
      std::fill(part_distances_.begin() + frames_.begin[f],
                part_distances_.begin() + frames_.begin[f + 1], of_frames[f]);
    }
    for (const Neighbor& n : exemplars_[p].compared()) part_distances_[n.sample] = n.distance;
    for (const std::uint32_t f : compared_frames_) {
      for (std::uint32_t i = frames_.begin[f]; i < frames_.begin[f + 1]; ++i) {
        distances_[i] += far(part_distances_[i]);
      }
    }
  }
  for (std::uint32_t f = 0; f < compared_.size(); ++f) {
    if (compared_[f] != 0) continue;
    std::fill(distances_.begin() + frames_.begin[f], distances_.begin() + frames_.begin[f + 1],
              frame_sums_[f]);
  }
  return &distances_;
}

}  // namespace selovis

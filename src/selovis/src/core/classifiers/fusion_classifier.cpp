#include "fusion_classifier.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMinProbability = 1e-3;  // no single frame rules a place out
constexpr float kFar = 1.0f;              // relative squared distance from which a view is far
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
}

void FusionClassifier::predict(const float* signature, double* probabilities) {
  std::fill(sum_.begin(), sum_.end(), 0.0);
  distances_known_ = false;
  const float* part = signature;
  for (std::size_t p = 0; p < parts_.size(); part += parts_[p].size, ++p) {
    nearest_[p] = exemplars_[p].search(part).front().distance;
  }
  shareByRange(calibration_, parts_, nearest_, shares_);
  novelty_ = 0.0;
  double asked = 0.0, weights = 0.0;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    placeLogLikelihoods(exemplars_[p].nearest(), labels_, params_.beta, log_likelihoods_);
    const PartCalibration& c = calibration_.parts[p];
    const double weight = c.weight * shares_[p];
    const auto best = std::max_element(log_likelihoods_.begin(), log_likelihoods_.end());
    opinions_[p].place = static_cast<int>(best - log_likelihoods_.begin());
    opinions_[p].probability = std::exp(*best);
    opinions_[p].weight = weight;
    opinions_[p].out_of_range = rangeShare(c, nearest_[p]) <= 0.0;
    asked += weight;
    weights += c.weight;
    if (c.median > 0.0) novelty_ += c.weight * std::sqrt(nearest_[p] / c.median);
    for (std::size_t k = 0; k < sum_.size(); ++k) sum_[k] += weight * log_likelihoods_[k];
  }
  novelty_ /= std::max(weights, 1e-12);
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
        (probabilities[k] / total + kMinProbability) / (1.0 + kMinProbability * places_);
  }
}

const std::vector<float>* FusionClassifier::distances() const {
  if (distances_known_) return &distances_;
  distances_.assign(labels_.size(), 1.0f);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const float weight = static_cast<float>(opinions_[p].weight);
    if (weight <= 0.0f) continue;
    exemplars_[p].distances(part_distances_);
    const float nearest = static_cast<float>(std::max(kMinSquaredDistance, nearest_[p]));
    for (std::size_t i = 0; i < distances_.size(); ++i) {
      const float relative = (part_distances_[i] - nearest) / nearest;
      distances_[i] += kViewScale * weight * std::clamp(relative, 0.0f, kFar);
    }
  }
  distances_known_ = true;
  return &distances_;
}

}  // namespace selovis

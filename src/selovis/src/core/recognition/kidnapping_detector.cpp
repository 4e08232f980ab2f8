#include "selovis/recognition/kidnapping_detector.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace selovis {

using hyselam::InputError;

void KidnappingDetectorParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("correlation_time", correlation_time, Range::between(0.01, 10.0), "s",
        "frames nearer in time are not independent");
  visit("threshold", threshold, Range::between(1e-3, 1e3), "nat",
        "evidence against the pose that raises the alarm");
  visit("min_frame_probability", min_frame_probability, Range::between(1e-9, 0.1), "",
        "of a place by one frame: no frame rules a place out");
  visit("stay_probability", stay_probability, Range::between(0.0, 1.0), "",
        "of staying in a place for a second");
  visit("teleport_probability", teleport_probability, Range::between(0.0, 1.0), "",
        "per second, of being carried to any place");
  visit("min_place_probability", min_place_probability, Range::between(0.0, 1.0), "",
        "from which the place of a kidnapped robot is known");
}

void KidnappingDetectorParams::validate() const {
  hyselam::checkParameters(*this);
}

KidnappingDetector::KidnappingDetector(const PlaceTransitions& transitions,
                                       const KidnappingDetectorParams& params)
    : params_(params), paths_(shortestPaths(transitions)), next_(transitions.places.size()) {
  params.validate();
  const std::size_t n = transitions.places.size();
  if (n == 0) throw InputError("kidnapping detector", "", "needs at least one place");
  for (std::size_t from = 0; from < n; ++from) {
    int count = 0;
    for (std::size_t to = 0; to < n; ++to) count += paths_.distanceBetween(to, from) == 1;
    neighbor_counts_.push_back(count);
  }
  restart({});
}

void KidnappingDetector::reset() {
  evidence_ = 0.0;
  kidnapped_ = false;
  restart({});
}

void KidnappingDetector::declareLost() {
  evidence_ = params_.threshold;
  kidnapped_ = true;
  restart({});
}

void KidnappingDetector::restart(const std::vector<int>& expected) {
  elsewhere_.assign(next_.size(), 1.0);
  for (const int place : expected) elsewhere_[static_cast<std::size_t>(place)] = 0.0;
  double sum = 0.0;
  for (const double p : elsewhere_) sum += p;
  for (double& p : elsewhere_) {
    p = sum > 0.0 ? p / sum : 1.0 / static_cast<double>(elsewhere_.size());
  }
}

std::vector<KidnappingDetector::Role> KidnappingDetector::rolesOf(
    const std::vector<int>& expected, const std::vector<int>& unmapped) const {
  std::vector<Role> roles(next_.size(), Role::kElsewhere);
  const auto assign = [&](const std::vector<int>& places, Role role) {
    for (const int place : places) {
      if (place < 0 || static_cast<std::size_t>(place) >= roles.size()) {
        throw InputError("place of the pose", "", "is none of those that were learned");
      }
      roles[static_cast<std::size_t>(place)] = role;
    }
  };
  assign(unmapped, Role::kUnmapped);
  assign(expected, Role::kExpected);
  return roles;
}

void KidnappingDetector::predict(double seconds) {
  const double stay = std::pow(params_.stay_probability, seconds),
               teleport = 1.0 - std::pow(1.0 - params_.teleport_probability, seconds);
  const std::size_t n = next_.size();
  std::fill(next_.begin(), next_.end(), 0.0);
  for (std::size_t from = 0; from < n; ++from) {
    const bool isolated = neighbor_counts_[from] == 0;
    for (std::size_t to = 0; to < n; ++to) {
      if (to == from) {
        next_[to] += (isolated ? 1.0 : stay) * elsewhere_[from];
      } else if (paths_.distanceBetween(to, from) == 1) {
        next_[to] += (1.0 - stay) / neighbor_counts_[from] * elsewhere_[from];
      }
    }
  }
  for (double& p : next_) {
    p = (1.0 - teleport) * p + teleport / static_cast<double>(n);
  }
}

namespace {

/// Sum of the frame's probabilities; 1 if it is 0.
double checkedSum(const std::vector<double>& frame, std::size_t places) {
  if (frame.size() != places) {
    throw InputError("frame", "",
                     "has " + std::to_string(frame.size()) + " probabilities, but there are " +
                         std::to_string(places) + " places");
  }
  double total = 0.0;
  for (const double p : frame) {
    if (!(p >= 0.0) || !std::isfinite(p)) {
      throw InputError("frame", "", "has a probability that is negative or not finite");
    }
    total += p;
  }
  return total > 0.0 ? total : 1.0;  // all places are then equally unlikely
}

}  // namespace

KidnappingState KidnappingDetector::update(const std::vector<double>& frame,
                                           const std::vector<int>& expected,
                                           const std::vector<int>& unmapped, double seconds) {
  const std::size_t n = next_.size();
  seconds = std::max(0.0, seconds);
  const double exponent = std::min(1.0, seconds / params_.correlation_time);
  const double total = checkedSum(frame, n);
  const std::vector<Role> roles = rolesOf(expected, unmapped);
  const auto likelihood = [&](std::size_t i) {
    return std::pow(std::max(frame[i] / total, params_.min_frame_probability), exponent);
  };

  if (!kidnapped_ && evidence_ <= 0.0) restart(expected);
  predict(seconds);
  // "Elsewhere" excludes the expected places, but a robot that was kidnapped may have come back to
  // one of them.
  double elsewhere_prior = 0.0, elsewhere_posterior = 0.0, posterior = 0.0, unmapped_share = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double predicted = next_[i];
    next_[i] = predicted * likelihood(i);
    if (roles[i] == Role::kElsewhere) {
      elsewhere_prior += predicted;
      elsewhere_posterior += next_[i];
    } else if (roles[i] == Role::kUnmapped) {
      unmapped_share += frame[i] / total;
    } else if (!kidnapped_) {
      next_[i] = 0.0;
    }
    posterior += next_[i];
  }

  KidnappingState result;
  result.tested = !expected.empty() && elsewhere_prior > 0.0;
  if (result.tested) {
    double at_pose = 0.0;
    for (const int place : expected) {
      at_pose = std::max(at_pose, likelihood(static_cast<std::size_t>(place)));
    }
    const double ratio = std::log(elsewhere_posterior / elsewhere_prior / at_pose);
    evidence_ = std::clamp(evidence_ + (1.0 - unmapped_share) * ratio, 0.0, params_.threshold);
    if (!kidnapped_ && evidence_ >= params_.threshold) {
      kidnapped_ = result.alarm = true;
    } else if (kidnapped_ && evidence_ <= 0.0) {
      kidnapped_ = false;
    }
  }
  if (posterior > 0.0) {
    for (std::size_t i = 0; i < n; ++i) elsewhere_[i] = next_[i] / posterior;
  }
  result.kidnapped = kidnapped_;
  result.evidence = evidence_;
  if (kidnapped_) {
    const auto best = std::max_element(elsewhere_.begin(), elsewhere_.end());
    result.probability = *best;
    if (*best >= params_.min_place_probability) {
      result.place = static_cast<int>(best - elsewhere_.begin());
    }
  }
  return result;
}

}  // namespace selovis

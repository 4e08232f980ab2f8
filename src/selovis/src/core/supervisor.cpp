#include "selovis/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace selovis {

namespace {

enum class Role { kHere, kElsewhere, kUnmapped };  // of a place, for the hypotheses

}  // namespace

void validate(const SupervisorParams& p) {
  const auto check = [](const char* name, double value, double low, double high,
                        const char* allowed) {
    if (!(value >= low && value <= high)) throw hyselam::ParameterError(name, value, allowed);
  };
  check("trust", p.trust, 1e-3, 1.0, "0.001 to 1");
  check("threshold", p.threshold, 1e-3, 1e3, "0.001 to 1000");
  check("least", p.least, 1e-9, 0.1, "1e-9 to 0.1");
  check("stay", p.stay, 0.0, 1.0, "0 to 1");
  check("leak", p.leak, 0.0, 1.0, "0 to 1");
  check("known_from", p.known_from, 0.0, 1.0, "0 to 1");
}

Supervisor::Supervisor(const PlaceGraph& graph, const SupervisorParams& params)
    : params_(params), paths_(shortestPaths(graph)), next_(graph.places.size()) {
  validate(params);
  const std::size_t n = graph.places.size();
  if (n == 0) throw std::invalid_argument("a supervisor needs at least one place");
  for (std::size_t from = 0; from < n; ++from) {
    int count = 0;
    for (std::size_t to = 0; to < n; ++to) count += paths_.distance[to * n + from] == 1;
    neighbours_.push_back(count);
  }
  restart({});
}

void Supervisor::reset() {
  evidence_ = 0.0;
  kidnapped_ = false;
  restart({});
}

void Supervisor::doubt() {
  evidence_ = params_.threshold;
  kidnapped_ = true;
  restart({});
}

void Supervisor::restart(const std::vector<int>& here) {
  elsewhere_.assign(next_.size(), 1.0);
  for (const int place : here) elsewhere_[static_cast<std::size_t>(place)] = 0.0;
  double sum = 0.0;
  for (const double p : elsewhere_) sum += p;
  for (double& p : elsewhere_) {
    p = sum > 0.0 ? p / sum : 1.0 / static_cast<double>(elsewhere_.size());
  }
}

Supervision Supervisor::update(const std::vector<double>& frame, const std::vector<int>& here,
                               const std::vector<int>& unmapped) {
  const std::size_t n = next_.size();
  if (frame.size() != n) {
    throw std::invalid_argument("there are " + std::to_string(n) + " places, but " +
                                std::to_string(frame.size()) + " probabilities");
  }
  double total = 0.0;
  for (const double p : frame) {
    if (!(p >= 0.0) || !std::isfinite(p)) {
      throw std::invalid_argument("a probability is negative or no number");
    }
    total += p;
  }
  std::vector<Role> roles(n, Role::kElsewhere);
  const auto give = [&](const std::vector<int>& places, Role role) {
    for (const int place : places) {
      if (place < 0 || place >= static_cast<int>(n)) {
        throw std::invalid_argument("a place of the pose is none of the graph's");
      }
      roles[static_cast<std::size_t>(place)] = role;
    }
  };
  give(unmapped, Role::kUnmapped);
  give(here, Role::kHere);
  if (total <= 0.0) total = 1.0;  // tells nothing: all places are equally unlikely
  const auto likelihood = [&](std::size_t i) {
    return std::pow(std::max(frame[i] / total, params_.least), params_.trust);
  };

  if (!kidnapped_ && evidence_ <= 0.0) restart(here);
  std::fill(next_.begin(), next_.end(), 0.0);
  for (std::size_t from = 0; from < n; ++from) {
    const bool alone = neighbours_[from] == 0;
    for (std::size_t to = 0; to < n; ++to) {
      if (to == from) {
        next_[to] += (alone ? 1.0 : params_.stay) * elsewhere_[from];
      } else if (paths_.distance[to * n + from] == 1) {
        next_[to] += (1.0 - params_.stay) / neighbours_[from] * elsewhere_[from];
      }
    }
  }
  // "Elsewhere" is no place of the pose; a robot that was kidnapped may have come back to one.
  double elsewhere_share = 0.0, elsewhere_witness = 0.0, witness = 0.0, says_nothing = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double predicted =
        (1.0 - params_.leak) * next_[i] + params_.leak / static_cast<double>(n);
    next_[i] = predicted * likelihood(i);
    if (roles[i] == Role::kElsewhere) {
      elsewhere_share += predicted;
      elsewhere_witness += next_[i];
    } else if (roles[i] == Role::kUnmapped) {
      says_nothing += frame[i] / total;
    } else if (!kidnapped_) {
      next_[i] = 0.0;
    }
    witness += next_[i];
  }

  Supervision result;
  result.judged = !here.empty() && elsewhere_share > 0.0;
  if (result.judged) {
    double at_pose = 0.0;
    for (const int place : here) {
      at_pose = std::max(at_pose, likelihood(static_cast<std::size_t>(place)));
    }
    const double ratio = std::log(elsewhere_witness / elsewhere_share / at_pose);
    evidence_ = std::clamp(evidence_ + (1.0 - says_nothing) * ratio, 0.0, params_.threshold);
    if (!kidnapped_ && evidence_ >= params_.threshold) {
      kidnapped_ = result.alarm = true;
    } else if (kidnapped_ && evidence_ <= 0.0) {
      kidnapped_ = false;
    }
  }
  if (witness > 0.0) {
    for (std::size_t i = 0; i < n; ++i) elsewhere_[i] = next_[i] / witness;
  }
  result.kidnapped = kidnapped_;
  result.evidence = evidence_;
  if (kidnapped_) {
    const auto best = std::max_element(elsewhere_.begin(), elsewhere_.end());
    result.probability = *best;
    if (*best >= params_.known_from) result.place = static_cast<int>(best - elsewhere_.begin());
  }
  return result;
}

}  // namespace selovis

#include "fsd_localization/models/beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fsd_localization/models/beam_sample.hpp"

namespace fsd_localization {

using hyselam::kPi;
using hyselam::Range;

void BeamModelParams::describe(hyselam::ParameterVisitor& visit) {
  visit("max_beams", max_beams, Range::between(1, 10000), "", "beams used of a scan");
  describeMaxRange(visit, max_range);
  visit("z_hit", z_hit, Range::between(0.0, 1.0), "", "share of returns from mapped obstacles");
  visit("z_short", z_short, Range::between(0.0, 1.0), "", "from something nearer");
  visit("z_max", z_max, Range::between(0.0, 1.0), "", "without return");
  visit("z_rand", z_rand, Range::between(1e-6, 1.0), "", "from anywhere");
  visit("sigma_hit", sigma_hit, Range::between(1e-3, 10.0), "m",
        "deviation of a return from the obstacle");
  visit("lambda_short", lambda_short, Range::between(1e-3, 100.0), "1/m",
        "decay of what is nearer");
}

void BeamModelParams::validate() const {
  hyselam::checkParameters(*this);
  checkMaxRange(max_range);
}

BeamModel::BeamModel(std::shared_ptr<const GridRayCaster> map, const BeamModelParams& params)
    : map_(std::move(map)), params_((params.validate(), params)) {}

std::optional<double> BeamModel::weigh(const Observation& observation, Particles& p) const {
  const BeamSample beams =
      sampleBeams(observation.scan, params_.max_beams, params_.max_range, true);
  if (beams.range.empty()) return std::nullopt;
  const double before = totalWeight(p);
  const double hit = params_.z_hit / (params_.sigma_hit * std::sqrt(2.0 * kPi));
  const double spread = -0.5 / (params_.sigma_hit * params_.sigma_hit);
  // The product of many densities fits no float: logarithms, relative to the best.
  std::vector<double> log_likelihood(p.size(), 0.0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const hyselam::Pose2 laser = laserPose(p, i, beams.laser_in_base);
    for (std::size_t b = 0; b < beams.range.size(); ++b) {
      const double expected =
          map_->range(laser.x, laser.y, laser.theta + beams.bearing[b], beams.max_range);
      const double z = beams.range[b], miss = z - expected;
      double q = params_.z_rand / beams.max_range + hit * std::exp(spread * miss * miss);
      if (miss < 0.0) {
        q += params_.z_short * params_.lambda_short * std::exp(-params_.lambda_short * z);
      }
      if (z >= beams.max_range) q += params_.z_max;
      log_likelihood[i] += std::log(q);
    }
  }
  const double best = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  for (std::size_t i = 0; i < p.size(); ++i) {
    p.weight[i] *= static_cast<float>(std::max(std::exp(log_likelihood[i] - best), 1e-30));
  }
  const auto factors = static_cast<double>(beams.range.size());
  return likelihoodPerFactor(before, totalWeight(p), factors) * std::exp(best / factors);
}

}  // namespace fsd_localization

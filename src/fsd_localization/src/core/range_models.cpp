#include "fsd_localization/range_models.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "check_range.hpp"

namespace fsd_localization {

using hyselam::kPi;

namespace {

/// Where the laser of a particle is, and which way it looks.
hyselam::Pose2 laserPose(const Particles& p, std::size_t i, const hyselam::Pose2& laser_in_base) {
  return p.pose(i) * hyselam::Pose2{laser_in_base.x, laser_in_base.y, 0.0};
}

}  // namespace

BeamSample sampleBeams(const hyselam::LaserScan& scan, int max_beams, double max_range,
                       bool keep_no_return) {
  BeamSample sample;
  sample.laser_in_base = scan.laser_in_base;
  sample.max_range = std::min(max_range, scan.range_max);
  const auto n = static_cast<int>(scan.ranges.size());
  const int count = std::min(n, max_beams);
  for (int k = 0; k < count; ++k) {
    const int i =
        count == 1 ? n / 2
                   : static_cast<int>(std::lround(static_cast<double>(k) * (n - 1) / (count - 1)));
    float r = scan.ranges[static_cast<std::size_t>(i)];
    if (std::isnan(r) || r < scan.range_min) continue;
    if (r >= sample.max_range) {
      if (!keep_no_return) continue;
      r = static_cast<float>(sample.max_range);
    }
    sample.bearing.push_back(
        static_cast<float>(scan.angle_min + i * scan.angle_increment + scan.laser_in_base.theta));
    sample.range.push_back(r);
  }
  return sample;
}

void BeamModelParams::validate() const {
  check("max_beams", max_beams, 1, 100000);
  check("max_range", max_range, 0.1, 1000.0);
  check("z_hit", z_hit, 0.0, 1.0);
  check("z_short", z_short, 0.0, 1.0);
  check("z_max", z_max, 0.0, 1.0);
  check("z_rand", z_rand, 1e-6, 1.0);
  check("sigma_hit", sigma_hit, 1e-3, 10.0);
  check("lambda_short", lambda_short, 1e-3, 100.0);
}

BeamModel::BeamModel(std::shared_ptr<const RayCaster> map, const BeamModelParams& params)
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
      if (miss < 0.0)
        q += params_.z_short * params_.lambda_short * std::exp(-params_.lambda_short * z);
      if (z >= beams.max_range) q += params_.z_max;
      log_likelihood[i] += std::log(q);
    }
  }
  const double best = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  for (std::size_t i = 0; i < p.size(); ++i)
    p.weight[i] *= static_cast<float>(std::max(std::exp(log_likelihood[i] - best), 1e-30));
  const auto factors = static_cast<double>(beams.range.size());
  return likelihoodPerFactor(before, totalWeight(p), factors) * std::exp(best / factors);
}

void CosineModelParams::validate() const {
  check("max_beams", max_beams, 1, 100000);
  check("max_range", max_range, 0.1, 1000.0);
  check("exponent", exponent, 0.1, 1000.0);
}

CosineModel::CosineModel(std::shared_ptr<const RayCaster> map, const CosineModelParams& params)
    : map_(std::move(map)), params_((params.validate(), params)) {}

std::optional<double> CosineModel::weigh(const Observation& observation, Particles& p) const {
  const BeamSample beams =
      sampleBeams(observation.scan, params_.max_beams, params_.max_range, true);
  double norm_r = 0.0;
  for (float r : beams.range) norm_r += static_cast<double>(r) * r;
  if (!(norm_r > 0.0)) return std::nullopt;
  const double before = totalWeight(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const hyselam::Pose2 laser = laserPose(p, i, beams.laser_in_base);
    double dot = 0.0, norm_p = 0.0;
    for (std::size_t b = 0; b < beams.range.size(); ++b) {
      const double expected =
          map_->range(laser.x, laser.y, laser.theta + beams.bearing[b], beams.max_range);
      dot += expected * beams.range[b];
      norm_p += expected * expected;
    }
    const double cosine = norm_p > 0.0 ? dot / std::sqrt(norm_p * norm_r) : 0.0;
    p.weight[i] = static_cast<float>(p.weight[i] * std::pow(cosine, params_.exponent));
  }
  return likelihoodPerFactor(before, totalWeight(p), 1.0);
}

}  // namespace fsd_localization

#include "fsd_localization/range_models.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::kPi;
using hyselam::ParameterError;

namespace {

void check(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw ParameterError(name, value,
                         "in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

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
  for (std::size_t i = 0; i < p.size(); ++i) {
    const hyselam::Pose2 laser = laserPose(p, i, beams.laser_in_base);
    double likelihood = 1.0;
    for (std::size_t b = 0; b < beams.range.size(); ++b) {
      const double expected =
          map_->range(laser.x, laser.y, laser.theta + beams.bearing[b], beams.max_range);
      const double z = beams.range[b], miss = z - expected;
      double q = params_.z_rand / beams.max_range + hit * std::exp(spread * miss * miss);
      if (miss < 0.0)
        q += params_.z_short * params_.lambda_short * std::exp(-params_.lambda_short * z);
      if (z >= beams.max_range) q += params_.z_max;
      likelihood *= q;
    }
    p.weight[i] = static_cast<float>(p.weight[i] * std::max(likelihood, 1e-30));
  }
  return likelihoodPerFactor(before, totalWeight(p), static_cast<double>(beams.range.size()));
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

void LikelihoodFieldParams::validate() const {
  check("max_beams", max_beams, 1, 100000);
  check("max_range", max_range, 0.1, 1000.0);
  check("z_hit", z_hit, 1e-6, 1.0);
  check("z_rand", z_rand, 1e-6, 1.0);
  check("sigma_hit", sigma_hit, 1e-3, 10.0);
  check("max_distance", max_distance, 0.01, 100.0);
  check("independent_beams", independent_beams, 0.1, 1e4);
  check("occupied_penalty", occupied_penalty, 1e-9, 1.0);
}

LikelihoodFieldModel::LikelihoodFieldModel(const hyselam::OccupancyGrid& map,
                                           const LikelihoodFieldParams& params,
                                           const OccupancyThresholds& thresholds)
    : params_((params.validate(), params)),
      distance_(distanceField(map, thresholds)),
      padded_width_(map.geometry.width + 2),
      free_(map.geometry.cellCount()) {
  const auto& g = map.geometry;
  const auto logLikelihood = [this](double d) {
    const double hit = d > params_.max_distance
                           ? 0.0
                           : std::exp(-0.5 * d * d / (params_.sigma_hit * params_.sigma_hit));
    return std::log(params_.z_hit * hit + params_.z_rand);
  };
  const double best = logLikelihood(0.0);
  step_ = (best - std::log(params_.z_rand)) / 255.0;
  cost_.assign(static_cast<std::size_t>(padded_width_) * static_cast<std::size_t>(g.height + 2),
               255);
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      cost_[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(padded_width_) +
            static_cast<std::size_t>(x + 1)] =
          static_cast<std::uint8_t>(
              std::lround((best - logLikelihood(distance_.at({x, y}))) / step_));
      const int v = map.at({x, y});
      free_[g.index({x, y})] = v >= 0 && v < thresholds.free_below;
    }
}

std::optional<double> LikelihoodFieldModel::weigh(const Observation& observation,
                                                  Particles& p) const {
  const BeamSample beams =
      sampleBeams(observation.scan, params_.max_beams, params_.max_range, false);
  const std::size_t n = beams.range.size();
  if (n == 0) return std::nullopt;
  const double before = totalWeight(p);
  // Ends of the beams in the base frame, in cells.
  const auto& g = distance_.geometry;
  const auto per_metre = static_cast<float>(1.0 / g.resolution);
  std::vector<float> ex(n), ey(n);
  std::vector<std::int32_t> cell(n);
  for (std::size_t b = 0; b < n; ++b) {
    ex[b] =
        static_cast<float>(beams.laser_in_base.x + beams.range[b] * std::cos(beams.bearing[b])) *
        per_metre;
    ey[b] =
        static_cast<float>(beams.laser_in_base.y + beams.range[b] * std::sin(beams.bearing[b])) *
        per_metre;
  }
  const float scale = static_cast<float>(
      -step_ * std::min(1.0, params_.independent_beams / static_cast<double>(n)));
  const auto x_max = static_cast<float>(g.width + 1), y_max = static_cast<float>(g.height + 1);
  const std::int32_t width = padded_width_;
  for (std::size_t i = 0; i < p.size(); ++i) {
    float s, c;
    sinCos(p.heading[i], s, c);
    const float px = p.x[i] * per_metre + 1.0F, py = p.y[i] * per_metre + 1.0F;
    for (std::size_t b = 0; b < n; ++b) {
      const float x = std::min(std::max(px + c * ex[b] - s * ey[b], 0.0F), x_max);
      const float y = std::min(std::max(py + s * ex[b] + c * ey[b], 0.0F), y_max);
      cell[b] = static_cast<std::int32_t>(y) * width + static_cast<std::int32_t>(x);
    }
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < n; ++b) sum += cost_[static_cast<std::size_t>(cell[b])];
    float w = std::exp(scale * static_cast<float>(sum));
    const hyselam::Cell at{static_cast<int>(std::floor(px)) - 1,
                           static_cast<int>(std::floor(py)) - 1};
    if (!g.contains(at) || !free_[g.index(at)]) w *= static_cast<float>(params_.occupied_penalty);
    p.weight[i] *= w;
  }
  return likelihoodPerFactor(before, totalWeight(p),
                             std::min<double>(params_.independent_beams, static_cast<double>(n)));
}

std::optional<double> LikelihoodFieldModel::explainedShare(const hyselam::LaserScan& scan,
                                                           const hyselam::Pose2& base_in_grid,
                                                           double tolerance) const {
  const BeamSample beams =
      sampleBeams(scan, static_cast<int>(scan.ranges.size()), params_.max_range, false);
  if (beams.range.empty()) return std::nullopt;
  int explained = 0;
  const hyselam::Pose2 laser =
      base_in_grid * hyselam::Pose2{scan.laser_in_base.x, scan.laser_in_base.y, 0.0};
  for (std::size_t b = 0; b < beams.range.size(); ++b) {
    const double a = laser.theta + beams.bearing[b];
    const auto& g = distance_.geometry;
    const hyselam::Cell end{
        static_cast<int>(std::floor((laser.x + beams.range[b] * std::cos(a)) / g.resolution)),
        static_cast<int>(std::floor((laser.y + beams.range[b] * std::sin(a)) / g.resolution))};
    if (g.contains(end) && distance_.at(end) <= tolerance) ++explained;
  }
  return static_cast<double>(explained) / static_cast<double>(beams.range.size());
}

}  // namespace fsd_localization

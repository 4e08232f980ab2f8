#include "fsd_localization/models/likelihood_field_model.hpp"

#include <algorithm>
#include <cmath>

namespace fsd_localization {

using hyselam::OccupancyGrid;
using hyselam::Range;

namespace {
constexpr double kFinestCell = 0.03;                     // [m] cells of the table are not smaller
constexpr std::size_t kMaxTable = std::size_t{1} << 25;  // [bytes] the table is not larger
}  // namespace

void LikelihoodFieldParams::describe(hyselam::ParameterVisitor& visit) {
  visit("max_beams", max_beams, Range::between(1, 10000), "", "beams used of a scan");
  describeMaxRange(visit, max_range);
  visit("z_hit", z_hit, Range::between(1e-6, 1.0), "", "share of returns from mapped obstacles");
  visit("z_rand", z_rand, Range::between(1e-6, 1.0), "", "from anywhere");
  visit("sigma_hit", sigma_hit, Range::between(1e-3, 10.0), "m",
        "deviation of a return from the obstacle");
  visit("max_distance", max_distance, Range::between(0.01, 100.0), "m",
        "beyond it an obstacle is not there");
  visit("independent_beams", independent_beams, Range::between(0.1, 1e4), "",
        "what the beams of a scan count as");
  visit("occupied_penalty", occupied_penalty, Range::between(1e-9, 1.0), "",
        "factor on an obstacle and off the map");
  visit("surface_offset", surface_offset, Range::between(0.0, 0.5), "cells",
        "from the center of a wall's outermost cell to its surface: 0.5 on drawn plans, 0 where "
        "cells mark laser returns");
}

void LikelihoodFieldParams::validate() const {
  hyselam::checkParameters(*this);
  checkMaxRange(max_range);
}

LikelihoodFieldModel::LikelihoodFieldModel(const OccupancyGrid& map,
                                           const LikelihoodFieldParams& params,
                                           const OccupancyThresholds& thresholds)
    : params_((params.validate(), params)), geometry_(map.geometry) {
  const DistanceField distance = distanceField(map, thresholds);
  const auto logLikelihood = [this](double d) {
    const double hit = d > params_.max_distance
                           ? 0.0
                           : std::exp(-0.5 * d * d / (params_.sigma_hit * params_.sigma_hit));
    return std::log(params_.z_hit * hit + params_.z_rand);
  };
  best_ = logLikelihood(0.0);
  step_ = (best_ - std::log(params_.z_rand)) / 255.0;
  const auto costOf = [&](double d) {
    return static_cast<std::uint8_t>(std::lround((best_ - logLikelihood(d)) / step_));
  };

  int finer = 1;
  while (geometry_.resolution / finer > kFinestCell &&
         geometry_.cellCount() * static_cast<std::size_t>((finer + 1) * (finer + 1)) <= kMaxTable) {
    ++finer;
  }
  fine_resolution_ = geometry_.resolution / finer;
  fine_width_ = geometry_.width * finer + 2;
  fine_height_ = geometry_.height * finer + 2;
  cost_.assign(static_cast<std::size_t>(fine_width_) * static_cast<std::size_t>(fine_height_), 255);
  for (int y = 0; y < fine_height_ - 2; ++y) {
    for (int x = 0; x < fine_width_ - 2; ++x) {
      cost_[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(fine_width_) +
            static_cast<std::size_t>(x + 1)] =
          costOf(surfaceDistance(distance, (x + 0.5) / finer - 0.5, (y + 0.5) / finer - 0.5));
    }
  }

  occupied_.resize(geometry_.cellCount());
  for (std::size_t i = 0; i < occupied_.size(); ++i) {
    occupied_[i] = thresholds.isOccupied(map.cells[i]);
  }
}

double LikelihoodFieldModel::surfaceDistance(const DistanceField& distance, double x,
                                             double y) const {
  // Outside positive, inside negative; between the centres of cells bilinear.
  const double offset = params_.surface_offset * geometry_.resolution;
  const double inner = geometry_.resolution - offset;  // from the surface to the first open centre
  const auto signedDistance = [&](int cx, int cy) {
    const std::size_t i = geometry_.index(
        {std::clamp(cx, 0, geometry_.width - 1), std::clamp(cy, 0, geometry_.height - 1)});
    return distance.to_occupied[i] > 0.0F ? distance.to_occupied[i] - offset
                                          : inner - distance.to_open[i];
  };
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double a = x - i, b = y - j;
  return std::abs((1.0 - b) * ((1.0 - a) * signedDistance(i, j) + a * signedDistance(i + 1, j)) +
                  b * ((1.0 - a) * signedDistance(i, j + 1) + a * signedDistance(i + 1, j + 1)));
}

LikelihoodFieldModel::Ends LikelihoodFieldModel::endsOf(const BeamSample& beams) const {
  Ends ends;
  for (std::size_t b = 0; b < beams.range.size(); ++b) {
    const double x = beams.laser_in_base.x + beams.range[b] * std::cos(beams.bearing[b]);
    const double y = beams.laser_in_base.y + beams.range[b] * std::sin(beams.bearing[b]);
    ends.x.push_back(static_cast<float>(x / fine_resolution_));
    ends.y.push_back(static_cast<float>(y / fine_resolution_));
  }
  ends.cell.resize(ends.x.size());
  return ends;
}

void LikelihoodFieldModel::lookUp(float px, float py, BinaryAngle heading, Ends& ends) const {
  const auto per_meter = static_cast<float>(1.0 / fine_resolution_);
  const auto x_max = static_cast<float>(fine_width_ - 1),
             y_max = static_cast<float>(fine_height_ - 1);
  const std::int32_t width = fine_width_;
  float s, c;
  sinCos(heading, s, c);
  const float x0 = px * per_meter + 1.0F, y0 = py * per_meter + 1.0F;
  for (std::size_t b = 0; b < ends.x.size(); ++b) {
    const float x = std::min(std::max(x0 + c * ends.x[b] - s * ends.y[b], 0.0F), x_max);
    const float y = std::min(std::max(y0 + s * ends.x[b] + c * ends.y[b], 0.0F), y_max);
    ends.cell[b] = static_cast<std::int32_t>(y) * width + static_cast<std::int32_t>(x);
  }
}

std::optional<double> LikelihoodFieldModel::weigh(const Observation& observation,
                                                  Particles& p) const {
  Ends ends = endsOf(sampleBeams(observation.scan, params_.max_beams, params_.max_range, false));
  const std::size_t n = ends.x.size();
  if (n == 0) return std::nullopt;
  const double before = totalWeight(p);
  const double factors = std::min(static_cast<double>(n), params_.independent_beams);
  const auto scale = static_cast<float>(-step_ * factors / static_cast<double>(n));
  const auto width = static_cast<double>(geometry_.width),
             height = static_cast<double>(geometry_.height);
  for (std::size_t i = 0; i < p.size(); ++i) {
    lookUp(p.x[i], p.y[i], p.heading[i], ends);
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < n; ++b) sum += cost_[static_cast<std::size_t>(ends.cell[b])];
    float w = std::exp(scale * static_cast<float>(sum));
    const double cx = p.x[i] / geometry_.resolution, cy = p.y[i] / geometry_.resolution;
    const bool inside = cx >= 0.0 && cy >= 0.0 && cx < width && cy < height;
    if (!inside || occupied_[geometry_.index({static_cast<int>(cx), static_cast<int>(cy)})]) {
      w *= static_cast<float>(params_.occupied_penalty);
    }
    p.weight[i] *= w;
  }
  return likelihoodPerFactor(before, totalWeight(p), factors);
}

/// The cost grows with the distance, so the distance of inliers is a limit on the cost.
double LikelihoodFieldModel::largestCost(double inlier_distance) const {
  const double hit =
      std::exp(-0.5 * inlier_distance * inlier_distance / (params_.sigma_hit * params_.sigma_hit));
  // The largest cost means only "far away": never an inlier.
  return std::min(254.0, (best_ - std::log(params_.z_hit * hit + params_.z_rand)) / step_);
}

std::vector<bool> LikelihoodFieldModel::areInliers(const std::vector<hyselam::Point2>& in_grid,
                                                   double inlier_distance) const {
  const double limit = largestCost(inlier_distance);
  std::vector<bool> inliers;
  inliers.reserve(in_grid.size());
  for (const hyselam::Point2& p : in_grid) {
    const double x = std::clamp(p.x / fine_resolution_ + 1.0, 0.0, fine_width_ - 1.0);
    const double y = std::clamp(p.y / fine_resolution_ + 1.0, 0.0, fine_height_ - 1.0);
    const auto cell = static_cast<std::size_t>(y) * static_cast<std::size_t>(fine_width_) +
                      static_cast<std::size_t>(x);
    inliers.push_back(cost_[cell] <= limit);
  }
  return inliers;
}

std::optional<double> LikelihoodFieldModel::inlierRatio(const hyselam::LaserScan& scan,
                                                        const hyselam::Pose2& base_in_grid,
                                                        double inlier_distance) const {
  Ends ends =
      endsOf(sampleBeams(scan, static_cast<int>(scan.ranges.size()), params_.max_range, false));
  if (ends.x.empty()) return std::nullopt;
  lookUp(static_cast<float>(base_in_grid.x), static_cast<float>(base_in_grid.y),
         toBinaryAngle(base_in_grid.theta), ends);
  const double limit = largestCost(inlier_distance);
  std::size_t inliers = 0;
  for (const std::int32_t cell : ends.cell) {
    inliers += cost_[static_cast<std::size_t>(cell)] <= limit ? 1 : 0;
  }
  return static_cast<double>(inliers) / static_cast<double>(ends.x.size());
}

}  // namespace fsd_localization

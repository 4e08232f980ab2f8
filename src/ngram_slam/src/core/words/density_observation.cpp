#include "ngram_slam/words/density_observation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::InputError;
using hyselam::Pose2;

DistanceSampler::DistanceSampler(double step) : step_(step) {
  if (!(step > 0.0 && std::isfinite(step))) {
    throw hyselam::ParameterError("observation step", step, "> 0 [m]");
  }
}

std::vector<Pose2> DistanceSampler::due(const Pose2& pose) {
  if (!last_ || hyselam::distance(*last_, pose) > kMaxGap) {
    last_ = pose;
    return {pose};
  }
  const double way = hyselam::distance(*last_, pose);
  // A hair of tolerance: 0.1 m of odometry may come out as 0.0999999.
  const auto steps = static_cast<int>(way / step_ + 1e-6);
  if (steps == 0) return {};
  std::vector<Pose2> poses;
  const double turn = hyselam::normalizeAngle(pose.theta - last_->theta);
  for (int k = 1; k <= steps; ++k) {
    const double share = std::min(1.0, k * step_ / way);
    poses.push_back({last_->x + share * (pose.x - last_->x), last_->y + share * (pose.y - last_->y),
                     hyselam::normalizeAngle(last_->theta + share * turn)});
  }
  last_ = poses.back();
  return poses;
}

void ObservationStore::startRun() {
  if (runs_.empty() || runs_.back().begin != size()) runs_.push_back({size(), 0.0, 0.0});
}

std::uint32_t ObservationStore::append(const DensityObservation& o) {
  const auto refuse = [](const char* what) {
    throw InputError("observation", what, "is out of range");
  };
  if (!std::isfinite(o.stamp)) refuse("stamp");
  if (!o.base_in_odom.isFinite()) refuse("pose");
  if (!(o.soft >= 0.0 && o.soft <= 1.0)) refuse("soft density");
  if (o.hard && !(*o.hard >= 0.0 && *o.hard <= 1.0)) refuse("hard density");
  if (o.full && !(*o.full >= 0.0 && *o.full <= 1.0)) refuse("full density");
  if (o.frontiers < 0 || o.frontiers > 255) refuse("number of frontiers");
  if (size() == std::numeric_limits<std::uint32_t>::max()) refuse("number of observations");

  const bool first = runs_.empty() || runs_.back().begin == size();
  const double x0 = first ? o.base_in_odom.x : runs_.back().x;
  const double y0 = first ? o.base_in_odom.y : runs_.back().y;
  const double dx = (o.base_in_odom.x - x0) / kLength, dy = (o.base_in_odom.y - y0) / kLength;
  if (std::abs(dx) > 2e9 || std::abs(dy) > 2e9) {
    refuse("position (200 km from the start of the run)");
  }
  if (runs_.empty()) startRun();
  runs_.back().x = x0;
  runs_.back().y = y0;

  const auto density = [](double v) {
    return static_cast<std::uint16_t>(std::lround(v * kDensitySteps));
  };
  stamps_.push_back(o.stamp);
  x_.push_back(static_cast<std::int32_t>(std::lround(dx)));
  y_.push_back(static_cast<std::int32_t>(std::lround(dy)));
  theta_.push_back(static_cast<std::int32_t>(
      std::lround(hyselam::normalizeAngle(o.base_in_odom.theta) / kAngle)));
  soft_.push_back(density(o.soft));
  hard_.push_back(o.hard ? density(*o.hard) : kUndefined);
  full_.push_back(o.full ? density(*o.full) : kUndefined);
  frontiers_.push_back(static_cast<std::uint8_t>(o.frontiers));
  return size() - 1;
}

std::uint32_t ObservationStore::runOf(std::uint32_t i) const {
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), i,
                                      [](std::uint32_t v, const Run& r) { return v < r.begin; });
  return static_cast<std::uint32_t>(after - runs_.begin()) - 1;
}

Pose2 ObservationStore::pose(std::uint32_t i) const {
  const Run& run = runs_[runOf(i)];
  return {run.x + x_[i] * kLength, run.y + y_[i] * kLength, theta_[i] * kAngle};
}

DensityObservation ObservationStore::operator[](std::uint32_t i) const {
  DensityObservation o;
  o.stamp = stamps_[i];
  o.base_in_odom = pose(i);
  o.soft = soft(i);
  if (hard_[i] != kUndefined) o.hard = hard_[i] * (1.0 / kDensitySteps);
  if (full_[i] != kUndefined) o.full = full_[i] * (1.0 / kDensitySteps);
  o.frontiers = frontiers_[i];
  return o;
}

std::size_t ObservationStore::bytes() const {
  return runs_.capacity() * sizeof(Run) + stamps_.bytes() + x_.bytes() + y_.bytes() +
         theta_.bytes() + soft_.bytes() + hard_.bytes() + full_.bytes() + frontiers_.bytes();
}

}  // namespace ngram_slam

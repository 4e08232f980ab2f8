#include "selovis/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMaxExtent = 5000.0;  // [m]
constexpr double kKnownTo = 0.8;       // of the reach: farther from all that was learnt is unlikely
constexpr double kUnknown = 1e-6;      // likelihood of being out of reach of everything
constexpr double kFastest = 5.0;       // [m/s] odometry that moves faster has jumped
constexpr double kSlack = 1.0;         // [m] and by more than this

}  // namespace

void validate(const PoseFilterParams& p) {
  const auto check = [](const char* name, double value, double low, double high,
                        const char* allowed) {
    if (!(value >= low && value <= high)) throw hyselam::ParameterError(name, value, allowed);
  };
  check("particles", p.particles, 10, 100000, "10 to 100000");
  check("pose_beta", p.beta, 0.0, 1000.0, "0 to 1000");
  check("pose_trust", p.trust, 1e-3, 10.0, "0.001 to 10");
  check("pose_reach", p.reach, 0.05, 20.0, "0.05 to 20");
  check("pose_turn", p.turn, 0.02, hyselam::kPi, "0.02 to pi");
  check("pose_doubt", p.doubt, 1e-6, 1e6, "1e-6 to 1e6");
  check("pose_jump", p.jump, 0.0, 1.0, "0 to 1");
  check("max_speed", p.max_speed, 0.0, 10.0, "0 to 10");
  check("max_turn", p.max_turn, 0.0, 10.0, "0 to 10");
}

PoseFilter::PoseFilter(const Samples& samples, int places, const PoseFilterParams& params)
    : params_(params), rng_(params.seed) {
  validate(params);
  if (samples.poses.size() != samples.count()) {
    throw std::invalid_argument("there is not one pose for each sample");
  }
  hyselam::Point2 low{1e300, 1e300}, high{-1e300, -1e300};
  int frame = -1;
  for (std::size_t i = 0; i < samples.count(); ++i) {
    const hyselam::Pose2& pose = samples.poses[i];
    if (!pose.isFinite()) continue;
    if (spots_.empty() || samples.frames[i] != frame) {
      const auto begin = static_cast<std::uint32_t>(views_.size());
      spots_.push_back({{pose.x, pose.y}, samples.places[i], begin, begin});
      frame = samples.frames[i];
    }
    views_.push_back({pose.theta, static_cast<std::uint32_t>(i)});
    spots_.back().end = static_cast<std::uint32_t>(views_.size());
    low = {std::min(low.x, pose.x), std::min(low.y, pose.y)};
    high = {std::max(high.x, pose.x), std::max(high.y, pose.y)};
  }
  if (spots_.empty()) throw std::invalid_argument("no training frame has a pose");
  if (!(high.x - low.x <= kMaxExtent && high.y - low.y <= kMaxExtent)) {
    throw std::invalid_argument("the poses of the training frames lie more than 5 km apart");
  }
  origin_ = low;
  const double cell = std::max(params.reach, (high.x - low.x + high.y - low.y) / 4000.0);
  params_.reach = std::min(params.reach, cell);
  columns_ = static_cast<int>((high.x - low.x) / cell) + 1;
  rows_ = static_cast<int>((high.y - low.y) / cell) + 1;
  const auto bucketOf = [&](const Spot& s) {
    return static_cast<std::size_t>((s.at.y - origin_.y) / cell) *
               static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>((s.at.x - origin_.x) / cell);
  };
  std::stable_sort(spots_.begin(), spots_.end(),
                   [&](const Spot& a, const Spot& b) { return bucketOf(a) < bucketOf(b); });
  bucket_begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Spot& s : spots_) ++bucket_begin_[bucketOf(s) + 1];
  std::partial_sum(bucket_begin_.begin(), bucket_begin_.end(), bucket_begin_.begin());
  cell_ = cell;
  const auto n = static_cast<std::size_t>(params.particles);
  particles_.resize(n);
  next_.resize(n);
  weights_.resize(n);
  likeness_.resize(samples.count());
  state_.resize(static_cast<std::size_t>(places));
  reset();
}

void PoseFilter::reset() {
  std::fill(state_.begin(), state_.end(), 1.0 / static_cast<double>(state_.size()));
  rng_ = hyselam::Rng(params_.seed);
  odometry_.reset();
  jumps_due_ = 0.0;
  fresh_ = true;
}

/// Near a view, chosen by likeness.
hyselam::Pose2 PoseFilter::drawn(double total) {
  double left = rng_.uniform() * total;
  const Spot* spot = &spots_.back();
  std::size_t view = views_.size() - 1;
  for (const Spot& s : spots_) {
    for (std::uint32_t v = s.begin; v < s.end; ++v) {
      left -= likeness_[views_[v].sample];
      if (left < 0.0) {
        spot = &s;
        view = v;
        break;
      }
    }
    if (left < 0.0) break;
  }
  return {spot->at.x + rng_.gaussian(0.0, 0.3), spot->at.y + rng_.gaussian(0.0, 0.3),
          hyselam::normalizeAngle(views_[view].heading + rng_.gaussian(0.0, 0.2))};
}

void PoseFilter::move(const std::optional<hyselam::Pose2>& odometry, double seconds) {
  hyselam::Pose2 step;
  if (odometry && odometry_) step = hyselam::between(*odometry_, *odometry);
  const double length = std::hypot(step.x, step.y);
  if (odometry && odometry_ && length <= kSlack + kFastest * seconds) {
    const double turn = std::abs(step.theta), still = std::sqrt(std::min(1.0, seconds));
    for (auto& p : particles_) {
      p = p * hyselam::Pose2{
                  step.x + rng_.gaussian(0.0, 0.02 * still + 0.15 * length),
                  step.y + rng_.gaussian(0.0, 0.02 * still + 0.05 * length),
                  step.theta + rng_.gaussian(0.0, 0.015 * still + 0.1 * turn + 0.05 * length)};
    }
    return;
  }
  // Drives on, or turns on the spot.
  for (auto& p : particles_) {
    const bool turns = rng_.uniform() < 0.35;
    const double way = turns ? 0.0 : rng_.uniform(0.0, params_.max_speed);
    const double turn = turns ? rng_.uniform(-params_.max_turn, params_.max_turn)
                              : rng_.gaussian(0.0, 0.25 * params_.max_turn);
    p = p * hyselam::Pose2{seconds * way, 0.0, seconds * turn};
  }
}

double PoseFilter::likelihood(const hyselam::Pose2& pose, double unseen, int* place) const {
  const double across = std::floor((pose.x - origin_.x) / cell_),
               along = std::floor((pose.y - origin_.y) / cell_);
  *place = -1;
  // Also of one that drifted away farther than numbers of cells go.
  if (!(across >= -1.0 && across <= columns_ && along >= -1.0 && along <= rows_)) return kUnknown;
  const int column = static_cast<int>(across), row = static_cast<int>(along);
  const double reach2 = params_.reach * params_.reach, turn2 = params_.turn * params_.turn;
  double sum = params_.doubt * unseen, weight = params_.doubt, nearest = reach2;
  for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
    const int first = std::max(0, column - 1), last = std::min(columns_ - 1, column + 1);
    if (first > last) continue;
    const auto base = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_);
    for (std::uint32_t i = bucket_begin_[base + static_cast<std::size_t>(first)];
         i < bucket_begin_[base + static_cast<std::size_t>(last) + 1]; ++i) {
      const Spot& spot = spots_[i];
      const double dx = spot.at.x - pose.x, dy = spot.at.y - pose.y, d2 = dx * dx + dy * dy;
      if (d2 >= reach2) continue;
      if (d2 < nearest) {
        nearest = d2;
        *place = spot.place;
      }
      const double a = 1.0 - d2 / reach2;
      for (std::uint32_t v = spot.begin; v < spot.end; ++v) {
        double off = std::abs(views_[v].heading - pose.theta);
        if (off > hyselam::kPi) off = std::abs(2.0 * hyselam::kPi - off);
        const double b = 1.0 - off * off / turn2;
        if (b <= 0.0) continue;
        const double k = a * a * b * b;
        weight += k;
        sum += k * likeness_[views_[v].sample];
      }
    }
  }
  if (*place < 0) return kUnknown;
  const double out = std::sqrt(nearest) / params_.reach - kKnownTo;
  return sum / weight * (out > 0.0 ? std::exp(-50.0 * out * out) : 1.0);
}

void PoseFilter::update(const std::vector<float>& distances,
                        const std::optional<hyselam::Pose2>& camera, double seconds) {
  const std::optional<hyselam::Pose2> odometry =
      camera && camera->isFinite() ? camera : std::optional<hyselam::Pose2>();
  if (distances.size() != likeness_.size()) {
    throw std::invalid_argument("there are not as many distances as samples");
  }
  seconds = std::isfinite(seconds) ? std::max(0.0, seconds) : 1.0;
  const double pace = std::min(1.0, seconds);
  const bool first = fresh_;
  double least = 1e300, total = 0.0;
  for (const View& v : views_) least = std::min(least, static_cast<double>(distances[v.sample]));
  least = std::max(1e-9, least);
  for (const View& v : views_) {
    const double d = (static_cast<double>(distances[v.sample]) - least) / least;
    total += likeness_[v.sample] = std::exp(-params_.beta * d);
  }
  const double unseen = total / static_cast<double>(views_.size());
  if (fresh_) {
    for (auto& p : particles_) p = drawn(total);
  } else {
    move(odometry, seconds);
    // Parts of a particle are carried over: at 30 frames a second they are all there is.
    jumps_due_ += params_.jump * pace * static_cast<double>(particles_.size());
    const auto jumps = static_cast<std::size_t>(std::max(0L, std::lround(jumps_due_)));
    jumps_due_ -= static_cast<double>(jumps);
    // Resampled particles lie in the order of those they come from: taken evenly.
    const std::size_t offset = rng_.below(static_cast<std::uint32_t>(particles_.size()));
    for (std::size_t i = 0; i < jumps; ++i) {
      particles_[(offset + i * particles_.size() / jumps) % particles_.size()] = drawn(total);
    }
  }
  odometry_ = odometry;
  std::fill(state_.begin(), state_.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    int place = -1;
    const double l = likelihood(particles_[i], unseen, &place);
    weights_[i] = std::pow(l, params_.trust * (fresh_ ? 1.0 : pace));
    if (place < 0) weights_[i] = std::min(weights_[i], kUnknown);
    sum += weights_[i];
    if (place >= 0) state_[static_cast<std::size_t>(place)] += weights_[i];
  }
  fresh_ = false;
  double known = 0.0;
  for (const double s : state_) known += s;
  if (!(known > 0.0)) {
    reset();  // driven out of all that was learnt: begun again with this frame
    if (!first) update(distances, odometry, seconds);
    return;
  }
  for (double& s : state_) s /= known;
  // Systematic resampling.
  const double step = sum / static_cast<double>(particles_.size());
  double at = rng_.uniform() * step, passed = 0.0;
  std::size_t from = 0;
  for (auto& p : next_) {
    while (from + 1 < particles_.size() && passed + weights_[from] < at) passed += weights_[from++];
    p = particles_[from];
    at += step;
  }
  particles_.swap(next_);
}

}  // namespace selovis

#include "selovis/filters/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMinLikelihood = 1e-6;  // of a pose with no training pose around it

// A likelihood falls off where the nearest training pose is farther than this share of the radius.
constexpr double kFullLikelihoodTo = 0.8;
constexpr double kFallOff = 50.0;

// Odometry has jumped if it moves faster than this and farther than this.
constexpr double kMaxOdometrySpeed = 5.0;  // [m/s]
constexpr double kMaxOdometryStep = 1.0;   // [m]

// Spread of a particle that is drawn near a training view.
constexpr double kDrawnPosition = 0.3;  // [m]
constexpr double kDrawnHeading = 0.2;   // [rad]

// Noise of the odometry: standard deviations along, across and of the heading, per second (root),
// per meter and per radian.
constexpr double kPositionPerSecond = 0.02, kHeadingPerSecond = 0.015;
constexpr double kAlongPerMeter = 0.15, kAcrossPerMeter = 0.05, kHeadingPerMeter = 0.05;
constexpr double kHeadingPerRadian = 0.1;

// Without odometry: share of the particles that turn on the spot, and the turn rate of the others.
constexpr double kTurningShare = 0.35;
constexpr double kDrivingTurn = 0.25;  // standard deviation, in max_turn_rate

const PoseFilterParams& checked(const PoseFilterParams& params) {
  params.validate();
  return params;
}

}  // namespace

void PoseFilterParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("particles", particles, Range::between(10, 100000), "", "of the filter poses");
  visit("similarity_beta", similarity_beta, Range::between(0.0, 1000.0), "",
        "similarity of an image to a view: exp(-beta (d^2 - d_min^2) / d_min^2)");
  visit("likelihood_exponent", likelihood_exponent, Range::between(1e-3, 10.0), "",
        "of one second of frames: consecutive frames are not independent");
  visit("kernel_radius", kernel_radius, Range::between(0.05, 20.0), "m",
        "a particle sees what was learned so near");
  visit("kernel_angle", kernel_angle, Range::between(0.02, hyselam::kPi), "rad",
        "and turned by less than this");
  visit("prior_weight", prior_weight, Range::between(1e-6, 1e6), "",
        "of the mean similarity of all views, in frames");
  visit("injection_rate", injection_rate, Range::between(0.0, 1.0), "1/s",
        "share of the particles redrawn near similar views");
  visit("max_speed", max_speed, Range::between(0.0, 10.0), "m/s", "of the robot without odometry");
  visit("max_turn_rate", max_turn_rate, Range::between(0.0, 10.0), "rad/s",
        "of the robot without odometry");
}

void PoseFilterParams::validate() const {
  hyselam::checkParameters(*this);
}

PoseFilter::PoseFilter(const Samples& samples, int places, const PoseFilterParams& params)
    : params_(checked(params)),
      views_(samples, params.kernel_radius, params.kernel_angle),
      rng_(params.seed) {
  const auto n = static_cast<std::size_t>(params.particles);
  particles_.resize(n);
  next_.resize(n);
  weights_.resize(n);
  state_.resize(static_cast<std::size_t>(places));
  reset();
}

void PoseFilter::reset() {
  std::fill(state_.begin(), state_.end(), 1.0 / static_cast<double>(state_.size()));
  rng_ = hyselam::Rng(params_.seed);
  odometry_.reset();
  injections_due_ = 0.0;
  first_ = true;
}

hyselam::Pose2 PoseFilter::drawPose(double total) {
  double left = rng_.uniform() * total;
  const LearnedViews::View* drawn = &views_.views().back();
  for (const LearnedViews::Frame& frame : views_.frames()) {
    for (std::uint32_t v = frame.begin; v < frame.end && left >= 0.0; ++v) {
      drawn = &views_.views()[v];
      left -= views_.similarity(*drawn);
    }
    if (left < 0.0) break;
  }
  const hyselam::Pose2 pose = views_.poseOf(*drawn);
  // Brace initialization draws in this order.
  return {pose.x + rng_.gaussian(0.0, kDrawnPosition), pose.y + rng_.gaussian(0.0, kDrawnPosition),
          hyselam::normalizeAngle(pose.theta + rng_.gaussian(0.0, kDrawnHeading))};
}

void PoseFilter::move(const std::optional<hyselam::Pose2>& odometry, double seconds) {
  hyselam::Pose2 step;
  if (odometry && odometry_) step = hyselam::between(*odometry_, *odometry);
  const double length = std::hypot(step.x, step.y);
  if (odometry && odometry_ && length <= kMaxOdometryStep + kMaxOdometrySpeed * seconds) {
    const double turn = std::abs(step.theta), root = std::sqrt(std::min(1.0, seconds));
    const double along = kPositionPerSecond * root + kAlongPerMeter * length,
                 across = kPositionPerSecond * root + kAcrossPerMeter * length,
                 heading = kHeadingPerSecond * root + kHeadingPerRadian * turn +
                           kHeadingPerMeter * length;
    for (auto& p : particles_) {
      p = p * hyselam::Pose2{step.x + rng_.gaussian(0.0, along),
                             step.y + rng_.gaussian(0.0, across),
                             step.theta + rng_.gaussian(0.0, heading)};
    }
    return;
  }
  // The robot drives on, or turns on the spot.
  for (auto& p : particles_) {
    const bool turns = rng_.uniform() < kTurningShare;
    const double speed = turns ? 0.0 : rng_.uniform(0.0, params_.max_speed);
    const double turn_rate = turns ? rng_.uniform(-params_.max_turn_rate, params_.max_turn_rate)
                                   : rng_.gaussian(0.0, kDrivingTurn * params_.max_turn_rate);
    p = p * hyselam::Pose2{seconds * speed, 0.0, seconds * turn_rate};
  }
}

PoseFilter::Likelihood PoseFilter::likelihood(const hyselam::Pose2& pose, double mean) const {
  const LearnedViews::Regression seen = views_.at(pose);
  if (seen.place < 0) return {kMinLikelihood, -1};
  const double value =
      (params_.prior_weight * mean + seen.sum) / (params_.prior_weight + seen.weight);
  const double beyond = std::sqrt(seen.nearest2) / params_.kernel_radius - kFullLikelihoodTo;
  return {value * (beyond > 0.0 ? std::exp(-kFallOff * beyond * beyond) : 1.0), seen.place};
}

void PoseFilter::injectParticles(double total, double seconds) {
  // Fractions of a particle are carried over: at 30 frames a second there is never a whole one.
  injections_due_ += params_.injection_rate * seconds * static_cast<double>(particles_.size());
  const auto count = static_cast<std::size_t>(std::max(0L, std::lround(injections_due_)));
  injections_due_ -= static_cast<double>(count);
  // Resampled particles lie in the order of those they come from: replaced at even distances.
  const std::size_t offset = rng_.below(static_cast<std::uint32_t>(particles_.size()));
  for (std::size_t i = 0; i < count; ++i) {
    particles_[(offset + i * particles_.size() / count) % particles_.size()] = drawPose(total);
  }
}

void PoseFilter::resample(double total_weight) {  // systematic resampling
  const double step = total_weight / static_cast<double>(particles_.size());
  double at = rng_.uniform() * step, passed = 0.0;
  std::size_t from = 0;
  for (auto& p : next_) {
    while (from + 1 < particles_.size() && passed + weights_[from] < at) passed += weights_[from++];
    p = particles_[from];
    at += step;
  }
  particles_.swap(next_);
}

void PoseFilter::update(const std::vector<float>& distances,
                        const std::optional<hyselam::Pose2>& camera, double seconds) {
  const std::optional<hyselam::Pose2> odometry =
      camera && camera->isFinite() ? camera : std::optional<hyselam::Pose2>();
  seconds = std::isfinite(seconds) ? std::max(0.0, seconds) : 1.0;
  const double frame_share = std::min(1.0, seconds);  // of a second's evidence
  const bool first = first_;
  const double total = views_.compare(distances, params_.similarity_beta);
  const double mean = total / static_cast<double>(views_.views().size());
  if (first_) {
    for (auto& p : particles_) p = drawPose(total);
  } else {
    move(odometry, seconds);
    injectParticles(total, frame_share);
  }
  odometry_ = odometry;
  std::fill(state_.begin(), state_.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const Likelihood l = likelihood(particles_[i], mean);
    weights_[i] = std::pow(l.value, params_.likelihood_exponent * (first_ ? 1.0 : frame_share));
    if (l.place < 0) weights_[i] = std::min(weights_[i], kMinLikelihood);
    sum += weights_[i];
    if (l.place >= 0) state_[static_cast<std::size_t>(l.place)] += weights_[i];
  }
  first_ = false;
  double known = 0.0;
  for (const double s : state_) known += s;
  if (!(known > 0.0)) {
    // No particle has a training pose around it: the filter begins again with this frame.
    reset();
    if (!first) update(distances, odometry, seconds);
    return;
  }
  for (double& s : state_) s /= known;
  resample(sum);
}

}  // namespace selovis

#include "selovis/filters/pose_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMaxExtent = 5000.0;  // [m]
constexpr double kMaxCells = 4000.0;   // of the grid, along its sides together
constexpr double kMinSquaredDistance = 1e-9;
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
    : params_(params), rng_(params.seed) {
  params.validate();
  const std::string problem = whyNot(samples);
  if (!problem.empty()) throw hyselam::InputError("training samples", "", problem);
  addTrainingPoses(samples);
  buildGrid(extentOf(samples));
  const auto n = static_cast<std::size_t>(params.particles);
  particles_.resize(n);
  next_.resize(n);
  weights_.resize(n);
  similarity_.resize(samples.count());
  state_.resize(static_cast<std::size_t>(places));
  reset();
}

PoseFilter::Extent PoseFilter::extentOf(const Samples& samples) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent e{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}};
  for (const hyselam::Pose2& p : samples.poses) {
    if (!p.isFinite()) continue;
    e.low = {std::min(e.low.x, p.x), std::min(e.low.y, p.y)};
    e.high = {std::max(e.high.x, p.x), std::max(e.high.y, p.y)};
  }
  return e;
}

std::string PoseFilter::whyNot(const Samples& samples) {
  if (samples.poses.size() != samples.count()) return "have not one pose each";
  const Extent e = extentOf(samples);
  if (e.high.x < e.low.x) return "no frame has a pose";
  const bool near = e.high.x - e.low.x <= kMaxExtent && e.high.y - e.low.y <= kMaxExtent;
  return near ? "" : "have poses more than 5 km apart";
}

void PoseFilter::addTrainingPoses(const Samples& samples) {
  int frame = -1;
  for (std::size_t i = 0; i < samples.count(); ++i) {
    const hyselam::Pose2& pose = samples.poses[i];
    if (!pose.isFinite()) continue;
    if (training_poses_.empty() || samples.frames[i] != frame) {
      const auto begin = static_cast<std::uint32_t>(views_.size());
      training_poses_.push_back({{pose.x, pose.y}, samples.places[i], begin, begin});
      frame = samples.frames[i];
    }
    views_.push_back({pose.theta, static_cast<std::uint32_t>(i)});
    training_poses_.back().end = static_cast<std::uint32_t>(views_.size());
  }
}

std::size_t PoseFilter::Grid::cellOf(const hyselam::Point2& p) const {
  return static_cast<std::size_t>((p.y - origin.y) / cell) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>((p.x - origin.x) / cell);
}

void PoseFilter::buildGrid(const Extent& extent) {
  const hyselam::Point2& low = extent.low;
  const double width = extent.high.x - low.x, height = extent.high.y - low.y;
  grid_.origin = low;
  grid_.cell = std::max(params_.kernel_radius, (width + height) / kMaxCells);
  grid_.columns = static_cast<int>(width / grid_.cell) + 1;
  grid_.rows = static_cast<int>(height / grid_.cell) + 1;
  std::stable_sort(training_poses_.begin(), training_poses_.end(),
                   [&](const TrainingPose& a, const TrainingPose& b) {
                     return grid_.cellOf(a.position) < grid_.cellOf(b.position);
                   });
  const auto cells = static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(grid_.rows);
  grid_.begin.assign(cells + 1, 0);
  for (const TrainingPose& t : training_poses_) ++grid_.begin[grid_.cellOf(t.position) + 1];
  std::partial_sum(grid_.begin.begin(), grid_.begin.end(), grid_.begin.begin());
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
  const TrainingPose* training = &training_poses_.back();
  std::size_t view = views_.size() - 1;
  for (const TrainingPose& t : training_poses_) {
    for (std::uint32_t v = t.begin; v < t.end; ++v) {
      left -= similarity_[views_[v].sample];
      if (left < 0.0) {
        training = &t;
        view = v;
        break;
      }
    }
    if (left < 0.0) break;
  }
  // Brace initialization draws in this order.
  return {training->position.x + rng_.gaussian(0.0, kDrawnPosition),
          training->position.y + rng_.gaussian(0.0, kDrawnPosition),
          hyselam::normalizeAngle(views_[view].heading + rng_.gaussian(0.0, kDrawnHeading))};
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
  const double across = std::floor((pose.x - grid_.origin.x) / grid_.cell),
               along = std::floor((pose.y - grid_.origin.y) / grid_.cell);
  // In floating point: a particle may have drifted farther than integers count.
  if (!(across >= -1.0 && across <= grid_.columns && along >= -1.0 && along <= grid_.rows)) {
    return {kMinLikelihood, -1};
  }
  const int column = static_cast<int>(across), row = static_cast<int>(along);
  const double radius2 = params_.kernel_radius * params_.kernel_radius,
               angle2 = params_.kernel_angle * params_.kernel_angle;
  double sum = params_.prior_weight * mean, weight = params_.prior_weight, nearest = radius2;
  int place = -1;
  for (int r = std::max(0, row - 1); r <= std::min(grid_.rows - 1, row + 1); ++r) {
    const int first = std::max(0, column - 1), last = std::min(grid_.columns - 1, column + 1);
    if (first > last) continue;
    const auto base = static_cast<std::size_t>(r) * static_cast<std::size_t>(grid_.columns);
    for (std::uint32_t i = grid_.begin[base + static_cast<std::size_t>(first)];
         i < grid_.begin[base + static_cast<std::size_t>(last) + 1]; ++i) {
      const TrainingPose& t = training_poses_[i];
      const double dx = t.position.x - pose.x, dy = t.position.y - pose.y, d2 = dx * dx + dy * dy;
      if (d2 >= radius2) continue;
      if (d2 < nearest) {
        nearest = d2;
        place = t.place;
      }
      const double a = 1.0 - d2 / radius2;
      for (std::uint32_t v = t.begin; v < t.end; ++v) {
        double off = std::abs(views_[v].heading - pose.theta);
        if (off > hyselam::kPi) off = std::abs(2.0 * hyselam::kPi - off);
        const double b = 1.0 - off * off / angle2;
        if (b <= 0.0) continue;
        const double kernel = a * a * b * b;  // biweight, of distance and of turn
        weight += kernel;
        sum += kernel * similarity_[views_[v].sample];
      }
    }
  }
  if (place < 0) return {kMinLikelihood, -1};
  const double beyond = std::sqrt(nearest) / params_.kernel_radius - kFullLikelihoodTo;
  return {sum / weight * (beyond > 0.0 ? std::exp(-kFallOff * beyond * beyond) : 1.0), place};
}

double PoseFilter::updateSimilarity(const std::vector<float>& distances) {
  double nearest = std::numeric_limits<double>::infinity(), total = 0.0;
  for (const View& v : views_) {
    nearest = std::min(nearest, static_cast<double>(distances[v.sample]));
  }
  nearest = std::max(kMinSquaredDistance, nearest);
  for (const View& v : views_) {
    const double d = (static_cast<double>(distances[v.sample]) - nearest) / nearest;
    total += similarity_[v.sample] = std::exp(-params_.similarity_beta * d);
  }
  return total;
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
  if (distances.size() != similarity_.size()) {
    throw hyselam::InputError("frame", "", "has not as many distances as there are samples");
  }
  seconds = std::isfinite(seconds) ? std::max(0.0, seconds) : 1.0;
  const double frame_share = std::min(1.0, seconds);  // of a second's evidence
  const bool first = first_;
  const double total = updateSimilarity(distances);
  const double mean = total / static_cast<double>(views_.size());
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

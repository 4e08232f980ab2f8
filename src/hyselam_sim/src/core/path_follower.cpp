#include "hyselam_sim/path_follower.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

// Above `kTurnFrom` the robot stops and turns on the spot until below `kTurnUntil`.
constexpr double kTurnFrom = hyselam::radians(60.0);
constexpr double kTurnUntil = hyselam::radians(8.0);
constexpr double kSearchAhead = 1.0;  // of the foot point [m]
constexpr double kCreep = 0.05;       // slowest driving speed [m/s]

}  // namespace

void FollowerParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("speed", speed, Range::inside(0.0, 1e6), "m/s", "cruising speed");
  visit("turn_rate", turn_rate, Range::inside(0.0, 1e6), "rad/s", "cruising turn rate");
  visit("look_ahead", look_ahead, Range::inside(0.0, 1e6), "m", "on open floor");
  visit("near_look_ahead", near_look_ahead, Range::inside(0.0, 1e6), "m", "in narrow passages");
  visit("open_clearance", open_clearance, Range::any(), "m",
        "from here on the floor counts as open");
  visit("arrival", arrival, Range::inside(0.0, 1e6), "m",
        "distance to the end that counts as arrived");
}

void FollowerParams::validate() const {
  hyselam::checkParameters(*this);
}

PathFollower::PathFollower(const FollowerParams& params, const RobotParams& robot)
    : params_(params), robot_(robot) {
  params.validate();
  if (params.speed > robot.max_speed) {
    throw hyselam::ParameterError("speed", params.speed, "at most the robot's maximum");
  }
}

void PathFollower::start(const std::vector<Point2>& path) {
  path_.clear();
  way_.clear();
  progress_ = 0.0;
  turning_ = false;
  arrived_ = path.size() < 2;
  extend(path);
}

void PathFollower::extend(const std::vector<Point2>& more) {
  for (const Point2& p : more) {
    const double step = path_.empty() ? 0.0 : length(p - path_.back());
    if (!path_.empty() && step < 1e-6) continue;
    way_.push_back(way_.empty() ? 0.0 : way_.back() + step);
    path_.push_back(p);
  }
  if (path_.size() < 2) arrived_ = true;
}

double PathFollower::remaining() const {
  return way_.empty() ? 0.0 : way_.back() - progress_;
}

double PathFollower::endDirection() const {
  const Point2 from = pointAt(std::max(0.0, way_.back() - 0.3));
  return std::atan2(path_.back().y - from.y, path_.back().x - from.x);
}

Point2 PathFollower::pointAt(double way) const {
  const auto next = std::upper_bound(way_.begin(), way_.end(), way);
  if (next == way_.end()) return path_.back();
  if (next == way_.begin()) return path_.front();
  const std::size_t i = static_cast<std::size_t>(next - way_.begin());
  const double t = (way - way_[i - 1]) / (way_[i] - way_[i - 1]);
  return path_[i - 1] + t * (path_[i] - path_[i - 1]);
}

DriveCommand PathFollower::command(const Pose2& pose, double clearance) {
  if (arrived_) return {};
  const Point2 at{pose.x, pose.y};

  // The nearest point of the path a little ahead; never back, so that crossings do not confuse.
  double nearest = 1e300;
  double foot = progress_;
  auto i = static_cast<std::size_t>(std::upper_bound(way_.begin(), way_.end(), progress_) -
                                    way_.begin());
  for (i = std::max<std::size_t>(i, 1); i < path_.size() && way_[i - 1] < progress_ + kSearchAhead;
       ++i) {
    const Point2 d = path_[i] - path_[i - 1];
    const double t = std::clamp(dot(at - path_[i - 1], d) / dot(d, d), 0.0, 1.0);
    const double off = length(at - (path_[i - 1] + t * d));
    if (off < nearest - 1e-12) {
      nearest = off;
      foot = way_[i - 1] + t * (way_[i] - way_[i - 1]);
    }
  }
  progress_ = std::max(progress_, foot);

  const double left = remaining();
  if (left < params_.arrival) {
    arrived_ = true;
    return {};
  }

  const double openness = std::clamp(
      (clearance - robot_.radius) / std::max(1e-3, params_.open_clearance - robot_.radius), 0.0,
      1.0);
  const double reach =
      params_.near_look_ahead + openness * (params_.look_ahead - params_.near_look_ahead);
  const Point2 target = pointAt(progress_ + reach);
  const double range = std::max(1e-3, length(target - at));
  const double bearing =
      hyselam::normalizeAngle(std::atan2(target.y - at.y, target.x - at.x) - pose.theta);

  turning_ = std::abs(bearing) > (turning_ ? kTurnUntil : kTurnFrom);
  if (turning_) {
    // Slow enough to stop at the bearing.
    const double rate = std::min(
        params_.turn_rate, 0.7 * std::sqrt(2.0 * robot_.turn_acceleration * std::abs(bearing)));
    return {0.0, std::copysign(rate, bearing)};
  }
  const double curvature = 2.0 * std::sin(bearing) / range;
  double speed = params_.speed * (0.5 + 0.5 * openness);
  if (std::abs(curvature) > 1e-9) speed = std::min(speed, params_.turn_rate / std::abs(curvature));
  speed = std::min(speed, std::sqrt(2.0 * 0.8 * robot_.acceleration * left));
  speed = std::max(speed, std::min(kCreep, params_.speed));
  return {speed, speed * curvature};
}

}  // namespace hyselam_sim

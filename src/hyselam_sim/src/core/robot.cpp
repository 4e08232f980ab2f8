#include "hyselam_sim/robot.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

double approach(double value, double target, double change) {
  return value + std::clamp(target - value, -change, change);
}

}  // namespace

void RobotParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("max_speed", max_speed, Range::inside(0.0, 1e6), "m/s", "");
  visit("max_turn_rate", max_turn_rate, Range::inside(0.0, 1e6), "rad/s", "");
  visit("acceleration", acceleration, Range::inside(0.0, 1e6), "m/s^2", "");
  visit("turn_acceleration", turn_acceleration, Range::inside(0.0, 1e6), "rad/s^2", "");
  visit("radius", radius, Range::inside(0.0, 1e6), "m", "of the disc it turns in");
  visit("wheel_base", wheel_base, Range::inside(0.0, 1e6), "m",
        "between the middles of the wheels");
}

void RobotParams::validate() const {
  hyselam::checkParameters(*this);
}

void OdometryParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("left_scale", left_scale, Range::inside(0.0, 1e6), "",
        "assumed / true radius of the left wheel");
  visit("right_scale", right_scale, Range::inside(0.0, 1e6), "", "of the right wheel");
  visit("base_scale", base_scale, Range::inside(0.0, 1e6), "", "assumed / true wheel base");
  visit("sigma", sigma, Range::fromBelow(0.0, 1.0), "m/sqrt(m)", "noise per wheel");
}

void OdometryParams::validate() const {
  hyselam::checkParameters(*this);
}

hyselam::Pose2 roll(const hyselam::Pose2& pose, double way, double turn) {
  // The chord of the arc; sin(x)/x by its series where the quotient loses its digits.
  const double half = 0.5 * turn;
  const double chord = std::abs(half) < 1e-6 ? way : way * std::sin(half) / half;
  const double direction = pose.theta + half;
  return {pose.x + chord * std::cos(direction), pose.y + chord * std::sin(direction),
          hyselam::normalizeAngle(pose.theta + turn)};
}

DifferentialRobot::DifferentialRobot(const RobotParams& params, const hyselam::Pose2& start)
    : params_((params.validate(), params)), pose_(start) {}

WheelMotion DifferentialRobot::step(double speed, double turn_rate, double dt) {
  speed_ = approach(speed_, std::clamp(speed, -params_.max_speed, params_.max_speed),
                    params_.acceleration * dt);
  turn_rate_ =
      approach(turn_rate_, std::clamp(turn_rate, -params_.max_turn_rate, params_.max_turn_rate),
               params_.turn_acceleration * dt);
  const double way = speed_ * dt, turn = turn_rate_ * dt;
  pose_ = roll(pose_, way, turn);
  const double across = 0.5 * params_.wheel_base * turn;
  return {way - across, way + across};
}

void DifferentialRobot::teleport(const hyselam::Pose2& pose) {
  pose_ = pose;
  speed_ = turn_rate_ = 0.0;
}

Odometry::Odometry(const OdometryParams& params, double wheel_base, const hyselam::Rng& rng)
    : params_((params.validate(), params)), wheel_base_(wheel_base), rng_(rng) {
  if (!(wheel_base > 0.0)) throw hyselam::ParameterError("wheel_base", wheel_base, "> 0 m");
}

void Odometry::update(const WheelMotion& motion) {
  const double left = motion.left * params_.left_scale +
                      params_.sigma * std::sqrt(std::abs(motion.left)) * rng_.gaussian();
  const double right = motion.right * params_.right_scale +
                       params_.sigma * std::sqrt(std::abs(motion.right)) * rng_.gaussian();
  pose_ = roll(pose_, 0.5 * (left + right), (right - left) / (wheel_base_ * params_.base_scale));
}

}  // namespace hyselam_sim

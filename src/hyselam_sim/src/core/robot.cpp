#include "hyselam_sim/robot.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

void requirePositive(const char* name, double value) {
  if (!(value > 0.0 && value < 1e6)) throw hyselam::ParameterError(name, value, "positive");
}

double approach(double value, double target, double change) {
  return value + std::clamp(target - value, -change, change);
}

}  // namespace

hyselam::Pose2 roll(const hyselam::Pose2& pose, double way, double turn) {
  // The chord of the arc; sin(x)/x by its series where the quotient loses its digits.
  const double half = 0.5 * turn;
  const double chord = std::abs(half) < 1e-6 ? way : way * std::sin(half) / half;
  const double direction = pose.theta + half;
  return {pose.x + chord * std::cos(direction), pose.y + chord * std::sin(direction),
          hyselam::normalizeAngle(pose.theta + turn)};
}

DifferentialRobot::DifferentialRobot(const RobotParams& params, const hyselam::Pose2& start)
    : params_(params), pose_(start) {
  requirePositive("max_speed", params.max_speed);
  requirePositive("max_turn_rate", params.max_turn_rate);
  requirePositive("acceleration", params.acceleration);
  requirePositive("turn_acceleration", params.turn_acceleration);
  requirePositive("radius", params.radius);
  requirePositive("wheel_base", params.wheel_base);
}

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
    : params_(params), wheel_base_(wheel_base), rng_(rng) {
  requirePositive("left_scale", params.left_scale);
  requirePositive("right_scale", params.right_scale);
  requirePositive("base_scale", params.base_scale);
  requirePositive("wheel_base", wheel_base);
  if (!(params.sigma >= 0.0 && params.sigma < 1.0)) {
    throw hyselam::ParameterError("sigma", params.sigma, "within [0, 1)");
  }
}

void Odometry::update(const WheelMotion& motion) {
  const double left = motion.left * params_.left_scale +
                      params_.sigma * std::sqrt(std::abs(motion.left)) * rng_.gaussian();
  const double right = motion.right * params_.right_scale +
                       params_.sigma * std::sqrt(std::abs(motion.right)) * rng_.gaussian();
  pose_ = roll(pose_, 0.5 * (left + right), (right - left) / (wheel_base_ * params_.base_scale));
}

}  // namespace hyselam_sim

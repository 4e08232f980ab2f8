// A Pioneer P3-DX (Maffei 2017, table A.1): two driven wheels, turning on the spot.
#pragma once

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/rng.hpp"

namespace hyselam_sim {

struct RobotParams {
  double max_speed = 1.4;                              ///< [m/s]
  double max_turn_rate = hyselam::radians(300.0);      ///< [rad/s]
  double acceleration = 0.5;                           ///< [m/s^2]
  double turn_acceleration = hyselam::radians(180.0);  ///< [rad/s^2]
  double radius = 0.267;                               ///< of the disc it turns in ("swing") [m]
  double wheel_base = 0.334;  ///< between the wheels' middles: width 381 mm - wheel 47.4 mm [m]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// What the wheels rolled on the ground in one step [m].
struct WheelMotion {
  double left = 0.0;
  double right = 0.0;
};

/// Where the robot really is. Follows commands within its limits, exactly along arcs.
class DifferentialRobot {
 public:
  /// @throws hyselam::ParameterError for limits that are not positive.
  DifferentialRobot(const RobotParams& params, const hyselam::Pose2& start);

  /// Moves for `dt` seconds towards the commanded speeds [m/s, rad/s].
  WheelMotion step(double speed, double turn_rate, double dt);

  /// Lifts the robot to another pose; it stands there. The wheels do not turn.
  void teleport(const hyselam::Pose2& pose);

  const hyselam::Pose2& pose() const { return pose_; }
  double speed() const { return speed_; }
  double turnRate() const { return turn_rate_; }

 private:
  RobotParams params_;
  hyselam::Pose2 pose_;
  double speed_ = 0.0;
  double turn_rate_ = 0.0;
};

/// Errors of dead reckoning: a systematic part (Borenstein and Feng's unequal wheels and uncertain
/// wheel base) and a random part that grows with the path length.
struct OdometryParams {
  double left_scale = 1.0005;   ///< assumed / true radius of the left wheel
  double right_scale = 0.9998;  ///< of the right wheel
  double base_scale = 1.005;    ///< assumed / true wheel base
  double sigma = 0.002;         ///< per wheel, of 1 m of path; grows with its root [m/sqrt(m)]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Dead reckoning from the wheels alone. Starts at the identity.
class Odometry {
 public:
  /// @throws hyselam::ParameterError for scales that are not positive or a negative sigma.
  Odometry(const OdometryParams& params, double wheel_base, const hyselam::Rng& rng);
  void update(const WheelMotion& motion);
  const hyselam::Pose2& pose() const { return pose_; }

 private:
  OdometryParams params_;
  double wheel_base_;
  hyselam::Rng rng_;
  hyselam::Pose2 pose_;
};

/// The pose after rolling along an arc of that length [m] and turn [rad].
hyselam::Pose2 roll(const hyselam::Pose2& pose, double length, double turn);

}  // namespace hyselam_sim

// Pure pursuit with speed limits: smooth on curves, slow in narrow passages, turning on the spot
// where the path turns back.
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/geometry.hpp"
#include "hyselam_sim/robot.hpp"

namespace hyselam_sim {

struct FollowerParams {
  double speed = 0.5;                         ///< cruising speed [m/s]
  double turn_rate = hyselam::radians(60.0);  ///< cruising turn rate [rad/s]
  double look_ahead = 0.6;                    ///< on open floor [m]
  double near_look_ahead = 0.3;               ///< in narrow passages [m]
  double open_clearance = 1.0;                ///< from here on the floor counts as open [m]
  double arrival = 0.05;                      ///< this close to the end is there [m]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

struct DriveCommand {
  double speed = 0.0;      ///< [m/s]
  double turn_rate = 0.0;  ///< [rad/s]
};

class PathFollower {
 public:
  PathFollower(const FollowerParams& params, const RobotParams& robot);

  /// Begins a new path (at least two points, starting at the robot).
  void start(const std::vector<Point2>& path);
  /// Goes on after the end of the present path; `more` begins where that one ends.
  void extend(const std::vector<Point2>& more);
  /// Path length left [m].
  double remaining() const;
  /// Direction of the present path at its end [rad].
  double endDirection() const;
  bool arrived() const { return arrived_; }

  /// What to drive now. `clearance` is the robot's distance to the nearest obstacle [m].
  DriveCommand command(const Pose2& pose, double clearance);

 private:
  Point2 pointAt(double way) const;

  FollowerParams params_;
  RobotParams robot_;
  std::vector<Point2> path_;
  std::vector<double> way_;  // along the path, of each point
  double progress_ = 0.0;    // way of the robot's foot point
  bool turning_ = false;
  bool arrived_ = true;
};

}  // namespace hyselam_sim

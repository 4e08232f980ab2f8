// How wrong the motions are that wheels tell: a model, and what the scans teach about it.
#pragma once

#include <Eigen/Core>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"

namespace ngram_slam {

/// Odometry noise model: standard deviations of a motion of `d` meters that turns by `a` radians.
struct OdometryNoise {
  double position_base = 0.01;        ///< of the position, constant term [m], > 0
  double position_per_meter = 0.1;    ///< [m/m], >= 0
  double position_per_radian = 0.05;  ///< [m/rad], >= 0
  double heading_base = 0.01;         ///< of the heading, constant term [rad], > 0
  double heading_per_radian = 0.1;    ///< [rad/rad], >= 0
  double heading_per_meter = 0.05;    ///< [rad/m], >= 0

  void describe(hyselam::ParameterVisitor& visit);
  double positionStddev(const hyselam::Pose2& motion) const;  ///< along each axis [m]
  double headingStddev(const hyselam::Pose2& motion) const;   ///< [rad]
  /// Inverse covariance of (x, y, theta) of the motion.
  Eigen::Matrix3d information(const hyselam::Pose2& motion) const;
  /// With all standard deviations of the position, and of the heading, this many times as large.
  OdometryNoise times(double position, double heading) const;
};

struct OdometryLearningParams {
  /// The model counts as much as this many keyframes at which it was right, > 0.
  double prior_keyframes = 10.0;
  double memory_keyframes = 200.0;  ///< older ones are forgotten, >= 1
  /// Standard deviations grow at most this much, >= 1; 1: nothing is learnt.
  double max_scale = 10.0;

  void describe(hyselam::ParameterVisitor& visit);
};

/// Learns from the corrections of the scans how much larger the errors of this robot's odometry are
/// than the model says: the scales of the standard deviations of position and heading, by maximum
/// likelihood with a prior at 1, older corrections forgotten. Scales are 1 at least: where a robot
/// drives for long on a good floor, the next slip is not to be a surprise.
class OdometryNoiseLearner {
 public:
  OdometryNoiseLearner(const OdometryNoise& model, const OdometryLearningParams& params);

  /// `motion`: by odometry; `correction`: the pose that the scans found in the frame of the one
  /// that odometry expects; `information`: of that pose by the scans alone.
  void add(const hyselam::Pose2& motion, const hyselam::Pose2& correction,
           const Eigen::Matrix3d& information);

  double positionScale() const { return position_.scale(params_); }
  double headingScale() const { return heading_.scale(params_); }
  /// The model with what was learnt.
  const OdometryNoise& noise() const { return noise_; }

 private:
  /// A weighted mean of squares, in variances of the model.
  struct Scale {
    double squares = 0.0, weight = 0.0;
    double scale(const OdometryLearningParams& p) const;
    void add(double square, double error, const OdometryLearningParams& p);
  };

  OdometryNoise model_, noise_;
  OdometryLearningParams params_;
  Scale position_, heading_;
};

}  // namespace ngram_slam

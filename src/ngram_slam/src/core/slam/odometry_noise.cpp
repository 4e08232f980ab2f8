#include "ngram_slam/slam/odometry_noise.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ngram_slam {

using hyselam::Pose2;
using hyselam::Range;

namespace {

// A larger correction counts as one of this many standard deviations: it may be a wrong match.
constexpr double kMaxDeviations = 3.0;

double square(double x) {
  return x * x;
}

}  // namespace

void OdometryNoise::describe(hyselam::ParameterVisitor& visit) {
  visit("position_base", position_base, Range::above(0.0), "m",
        "standard deviation of the position, of every motion");
  visit("position_per_meter", position_per_meter, Range::atLeast(0.0), "m/m",
        "standard deviation of the position, per meter driven");
  visit("position_per_radian", position_per_radian, Range::atLeast(0.0), "m/rad",
        "standard deviation of the position, per radian turned");
  visit("heading_base", heading_base, Range::above(0.0), "rad",
        "standard deviation of the heading, of every motion");
  visit("heading_per_radian", heading_per_radian, Range::atLeast(0.0), "rad/rad",
        "standard deviation of the heading, per radian turned");
  visit("heading_per_meter", heading_per_meter, Range::atLeast(0.0), "rad/m",
        "standard deviation of the heading, per meter driven");
}

double OdometryNoise::positionStddev(const Pose2& motion) const {
  return position_base + position_per_meter * std::hypot(motion.x, motion.y) +
         position_per_radian * std::abs(motion.theta);
}

double OdometryNoise::headingStddev(const Pose2& motion) const {
  return heading_base + heading_per_radian * std::abs(motion.theta) +
         heading_per_meter * std::hypot(motion.x, motion.y);
}

Eigen::Matrix3d OdometryNoise::information(const Pose2& motion) const {
  const double p = 1.0 / square(positionStddev(motion));
  return Eigen::Vector3d(p, p, 1.0 / square(headingStddev(motion))).asDiagonal();
}

OdometryNoise OdometryNoise::times(double position, double heading) const {
  OdometryNoise n = *this;
  n.position_base *= position;
  n.position_per_meter *= position;
  n.position_per_radian *= position;
  n.heading_base *= heading;
  n.heading_per_radian *= heading;
  n.heading_per_meter *= heading;
  return n;
}

void OdometryLearningParams::describe(hyselam::ParameterVisitor& visit) {
  visit("prior_keyframes", prior_keyframes, Range::above(0.0), "keyframes",
        "that the model of odometry noise counts for, where scans teach otherwise");
  visit("memory_keyframes", memory_keyframes, Range::atLeast(1.0), "keyframes",
        "after which what they taught is forgotten");
  visit("max_scale", max_scale, Range::atLeast(1.0), "",
        "standard deviations of odometry grow by this at most; 1: nothing is learnt");
}

double OdometryNoiseLearner::Scale::scale(const OdometryLearningParams& p) const {
  const double mean = (p.prior_keyframes + squares) / (p.prior_keyframes + weight);
  return std::clamp(std::sqrt(std::max(0.0, mean)), 1.0, p.max_scale);
}

/// `square`: of the correction; `error`: variance of the scan's own error in it.
void OdometryNoiseLearner::Scale::add(double square_of, double error,
                                      const OdometryLearningParams& p) {
  // As inaccurate as odometry itself, a scan says little about it.
  const double w = 1.0 / square(1.0 + error);
  const double now = square(scale(p));
  const double taken = std::min(square_of, square(kMaxDeviations) * (now + error)) - error;
  const double keep = 1.0 - 1.0 / p.memory_keyframes;
  squares = keep * squares + w * taken;
  weight = keep * weight + w;
}

OdometryNoiseLearner::OdometryNoiseLearner(const OdometryNoise& model,
                                           const OdometryLearningParams& params)
    : model_(model), noise_(model), params_(params) {}

void OdometryNoiseLearner::add(const Pose2& motion, const Pose2& correction,
                               const Eigen::Matrix3d& information) {
  // Along a bare corridor the scans say nothing, and the correction is what odometry says: only the
  // direction that they know best counts.
  const Eigen::Vector2d cross = information.topRightCorner<2, 1>();
  const double turn = information(2, 2);
  if (!(turn > 0.0)) return;
  const Eigen::Matrix2d position =
      information.topLeftCorner<2, 2>() - cross * cross.transpose() / turn;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(position);
  const double known = axes.eigenvalues()[1];
  if (known > 0.0) {
    const Eigen::Vector2d axis = axes.eigenvectors().col(1);
    const double variance = square(model_.positionStddev(motion));
    position_.add(square(axis.dot(Eigen::Vector2d(correction.x, correction.y))) / variance,
                  1.0 / (known * variance), params_);
  }
  // With the position unknown.
  const Eigen::Matrix2d corner = information.topLeftCorner<2, 2>();
  if (corner.determinant() > 0.0) {
    const double heading = turn - cross.dot(corner.inverse() * cross);
    if (heading > 0.0) {
      const double variance = square(model_.headingStddev(motion));
      heading_.add(square(correction.theta) / variance, 1.0 / (heading * variance), params_);
    }
  }
  noise_ = model_.times(positionScale(), headingScale());
}

}  // namespace ngram_slam

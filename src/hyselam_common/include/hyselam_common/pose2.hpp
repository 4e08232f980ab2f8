// Rigid motions of the plane, SE(2): x forward, y left, theta counter-clockwise (REP-103).
#pragma once

#include <cmath>

namespace hyselam {

constexpr double kPi = 3.14159265358979323846;

/// Degrees to radians, for readable literals.
constexpr double radians(double degrees) {
  return degrees * (kPi / 180.0);
}
constexpr double degrees(double radians) {
  return radians * (180.0 / kPi);
}

/// The angle wrapped to (-pi, pi]. NaN and infinities give NaN.
inline double normalizeAngle(double angle) {
  if (std::abs(angle) < kPi) return angle;  // nearly all, without a division
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// A point or displacement in the plane [m].
struct Point2 {
  double x = 0.0;
  double y = 0.0;
};

/// A pose of frame B in frame A, written `b_in_a`: maps points of B to A. Lengths [m], theta [rad].
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;

  /// Composition: (B in A) * (C in B) = C in A; theta is wrapped to (-pi, pi].
  Pose2 operator*(const Pose2& other) const {
    const double c = std::cos(theta), s = std::sin(theta);
    return {x + c * other.x - s * other.y, y + s * other.x + c * other.y,
            normalizeAngle(theta + other.theta)};
  }
  /// The point, given in B, expressed in A.
  Point2 operator*(const Point2& p) const {
    const double c = std::cos(theta), s = std::sin(theta);
    return {x + c * p.x - s * p.y, y + s * p.x + c * p.y};
  }
  /// A in B.
  Pose2 inverse() const {
    const double c = std::cos(theta), s = std::sin(theta);
    return {-c * x - s * y, s * x - c * y, normalizeAngle(-theta)};
  }
  bool isFinite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(theta); }
};

/// `to` seen from `from`: from.inverse() * to.
inline Pose2 between(const Pose2& from, const Pose2& to) {
  return from.inverse() * to;
}

/// Euclidean distance of the positions [m].
inline double distance(const Pose2& a, const Pose2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// A pose with its time [s].
struct StampedPose2 {
  double stamp = 0.0;
  Pose2 pose;
};

}  // namespace hyselam

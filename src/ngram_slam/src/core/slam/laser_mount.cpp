#include "ngram_slam/slam/laser_mount.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "hyselam_scan_matching/surface_map.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;
using hyselam::Range;

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kMapCell = 0.03;      // [m]
constexpr double kLikelyScale = 0.05;  // standard deviation of the scales of odometry, before
constexpr double kLikelyDrift = 0.05;  // and of its drift [rad/m]
// Of odometry in one pair: what is not systematic.
constexpr double kPositionPerMeter = 0.03, kHeadingPerRadian = 0.03, kHeadingPerMeter = 0.01;
constexpr double kFloor = 0.005;          // [m], [rad]
constexpr double kScanInformation = 0.1;  // points of a scan share errors
constexpr double kNear = 1.345;           // Huber's constant
constexpr int kIterations = 20;
constexpr double kStep = 1e-6;  // of the numerical derivative

struct Pair {
  Pose2 odometry;               // of the base
  Pose2 laser;                  // of the laser, by scans
  Eigen::Matrix3d information;  // of it
};

/// x, y, heading of the mount; scales of distance and rotation less one; drift of the heading.
Eigen::Vector3d errorOf(const Vector6& v, const Pair& p) {
  const Pose2 mount{v[0], v[1], v[2]};
  const double distance = std::hypot(p.odometry.x, p.odometry.y);
  const Pose2 base{p.odometry.x * (1.0 + v[3]), p.odometry.y * (1.0 + v[3]),
                   p.odometry.theta * (1.0 + v[4]) + v[5] * distance};
  const Pose2 error = between(p.laser, mount.inverse() * base * mount);
  return {error.x, error.y, error.theta};
}

/// Of the scan and of odometry's random errors.
Eigen::Matrix3d weightOf(const Pair& p, double lever) {
  const double distance = std::hypot(p.odometry.x, p.odometry.y);
  const double heading =
      kFloor + kHeadingPerMeter * distance + kHeadingPerRadian * std::abs(p.odometry.theta);
  const double position = kFloor + kPositionPerMeter * distance + lever * heading;
  const Eigen::Vector3d noise(position * position, position * position, heading * heading);
  const Eigen::Matrix3d scan =
      (kScanInformation * p.information + 1e-6 * Eigen::Matrix3d::Identity()).inverse();
  return (scan + Eigen::Matrix3d(noise.asDiagonal())).inverse();
}

/// Of a keyframe, in the frame of its laser.
hyselam_scan_matching::SurfacePoints laserPoints(const SlamKeyframe& k) {
  return transformed(k.scan->laser_in_base.inverse(), *k.points);
}

std::vector<std::pair<std::size_t, std::size_t>> pairsOf(const std::vector<SlamKeyframe>& keyframes,
                                                         const LaserMountParams& params) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::size_t first = 0;
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    if (keyframes[k].run != keyframes[first].run) {
      first = k;
      continue;
    }
    const Pose2 moved = between(keyframes[first].pose, keyframes[k].pose);
    if (std::hypot(moved.x, moved.y) < params.min_step && std::abs(moved.theta) < params.min_turn) {
      continue;
    }
    pairs.emplace_back(first, k);
    first = k;
  }
  const auto wanted = static_cast<std::size_t>(params.max_pairs);
  if (pairs.size() <= wanted) return pairs;
  std::vector<std::pair<std::size_t, std::size_t>> chosen;
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(pairs[i * pairs.size() / wanted]);
  return chosen;
}

std::vector<Pair> measured(const std::vector<SlamKeyframe>& keyframes,
                           const LaserMountParams& params) {
  std::vector<Pair> pairs;
  for (const auto& [a, b] : pairsOf(keyframes, params)) {
    const SlamKeyframe &older = keyframes[a], &newer = keyframes[b];
    hyselam_scan_matching::SurfaceMap map(kMapCell);
    map.insert({}, laserPoints(older));
    map.finish();
    const Pose2 mount = older.scan->laser_in_base;
    const Pose2 guess = mount.inverse() * between(older.pose, newer.pose) * mount;
    const auto found = alignIcp(laserPoints(newer), map, guess);
    if (found.matched < params.min_matched) continue;
    pairs.push_back({between(older.odometry, newer.odometry), found.pose, found.information});
  }
  return pairs;
}

/// Motions that odometry does not tell at all are left out: frozen wheels, jumps.
void leaveOutOutliers(std::vector<Pair>* pairs) {
  pairs->erase(std::remove_if(pairs->begin(), pairs->end(),
                              [](const Pair& p) {
                                const double told = std::hypot(p.odometry.x, p.odometry.y);
                                const double seen = std::hypot(p.laser.x, p.laser.y);
                                return std::abs(told - seen) > 0.25 + 0.3 * seen ||
                                       std::abs(p.odometry.theta - p.laser.theta) > 0.3;
                              }),
               pairs->end());
}

struct Solution {
  Vector6 value = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
};

/// Robust least squares from the mount as told.
Solution solve(const std::vector<Pair>& pairs, const Pose2& told) {
  Solution s;
  s.value.head<3>() << told.x, told.y, told.theta;
  Matrix6 prior = Matrix6::Zero();
  prior.diagonal().tail<3>() << 1.0 / (kLikelyScale * kLikelyScale),
      1.0 / (kLikelyScale * kLikelyScale), 1.0 / (kLikelyDrift * kLikelyDrift);
  Matrix6 h;
  double cost = 0.0;
  for (int i = 0; i < kIterations; ++i) {
    h = prior;
    Vector6 g = prior * (Vector6() << 0, 0, 0, s.value.tail<3>()).finished();
    cost = 0.0;
    const double lever = std::hypot(s.value[0], s.value[1]);
    for (const Pair& p : pairs) {
      const Eigen::Vector3d e = errorOf(s.value, p);
      Eigen::Matrix<double, 3, 6> j;
      for (int c = 0; c < 6; ++c) {
        Vector6 moved = s.value;
        moved[c] += kStep;
        j.col(c) = (errorOf(moved, p) - e) / kStep;
      }
      const Eigen::Matrix3d w = weightOf(p, lever);
      const double squares = e.dot(w * e), length = std::sqrt(squares / 3.0);
      const double robust = length <= kNear ? 1.0 : kNear / length;
      h += robust * j.transpose() * w * j;
      g += robust * j.transpose() * w * e;
      cost += robust * squares;
    }
    const Vector6 step = h.ldlt().solve(-g);
    if (!step.allFinite()) break;
    s.value += step;
    if (step.cwiseAbs().maxCoeff() < 1e-7) break;
  }
  const double freedom = std::max(1.0, 3.0 * static_cast<double>(pairs.size()) - 6.0);
  s.covariance = std::max(1.0, cost / freedom) * h.inverse();
  return s;
}

}  // namespace

void LaserMountParams::describe(hyselam::ParameterVisitor& visit) {
  visit("min_step", min_step, Range::above(0.0), "m", "between keyframes that are compared");
  visit("min_turn", min_turn, Range::above(0.0), "rad", "or turn between them");
  visit("min_matched", min_matched, Range::between(0.0, 1.0), "",
        "part of the points of a scan on the surfaces of the other");
  visit("max_pairs", max_pairs, Range::between(10, 1e6), "", "of keyframes, evenly chosen");
  visit("min_pairs", min_pairs, Range::between(10, 1e6), "", "fewer tell nothing");
  visit("significance", significance, Range::above(0.0), "",
        "standard deviations by which a mounting that is told wrong is off ...");
  visit("tolerance", tolerance, Range::above(0.0), "m", "... and at least so far");
  visit("angle_tolerance", angle_tolerance, Range::above(0.0), "rad", "or turned so much");
}

std::optional<LaserMount> estimateLaserMount(const std::vector<SlamKeyframe>& keyframes,
                                             const LaserMountParams& params) {
  hyselam::checkParameters(params);
  std::vector<Pair> pairs = measured(keyframes, params);
  leaveOutOutliers(&pairs);
  if (pairs.size() < static_cast<std::size_t>(params.min_pairs)) return std::nullopt;
  double turned = 0.0;
  for (const Pair& p : pairs) turned += std::abs(p.laser.theta);
  if (turned < 2.0 * hyselam::kPi) return std::nullopt;
  LaserMount mount;
  mount.told = keyframes.front().scan->laser_in_base;
  const Solution s = solve(pairs, mount.told);
  mount.estimated = {s.value[0], s.value[1], hyselam::normalizeAngle(s.value[2])};
  mount.stddev = s.covariance.diagonal().head<3>().cwiseSqrt();
  if (!mount.estimated.isFinite() || !mount.stddev.allFinite()) return std::nullopt;
  mount.pairs = static_cast<int>(pairs.size());
  mount.distance_scale = 1.0 / (1.0 + s.value[3]);
  mount.rotation_scale = 1.0 / (1.0 + s.value[4]);
  const double x = mount.estimated.x - mount.told.x, y = mount.estimated.y - mount.told.y;
  const double heading = hyselam::normalizeAngle(mount.estimated.theta - mount.told.theta);
  const auto isOff = [&](double error, double stddev, double tolerance) {
    return std::abs(error) > std::max(tolerance, params.significance * stddev);
  };
  mount.wrong_position =
      isOff(x, mount.stddev[0], params.tolerance) || isOff(y, mount.stddev[1], params.tolerance);
  mount.wrong_heading = isOff(heading, mount.stddev[2], params.angle_tolerance);
  return mount;
}

std::string LaserMount::text() const {
  if (!wrong()) return "the laser is mounted as told";
  const double x = estimated.x - told.x, y = estimated.y - told.y;
  const double heading = hyselam::normalizeAngle(estimated.theta - told.theta);
  std::ostringstream out;
  out << std::fixed << "the laser is not where it is told to be:";
  if (wrong_position) {
    out << std::setprecision(2) << " it is " << std::abs(x) << " m farther "
        << (x >= 0.0 ? "ahead" : "back") << " and " << std::abs(y) << " m farther to the "
        << (y >= 0.0 ? "left" : "right");
  }
  if (wrong_heading) {
    out << (wrong_position ? "," : " it is") << std::setprecision(1) << " turned by "
        << hyselam::degrees(heading) << " deg";
  }
  out << std::setprecision(3) << "; by " << pairs << " pairs of scans it is at x " << estimated.x
      << " m, y " << estimated.y << " m, " << std::setprecision(1)
      << hyselam::degrees(estimated.theta) << " deg of the base";
  return out.str();
}

}  // namespace ngram_slam

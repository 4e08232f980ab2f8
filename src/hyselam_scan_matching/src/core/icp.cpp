#include "hyselam_scan_matching/icp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_scan_matching {

namespace {

using hyselam::ParameterError;
using hyselam::Pose2;
using hyselam::Range;

/// Normal equations for a small motion (x, y, theta) in the frame of the pose.
struct Equations {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int pairs = 0;
};

/// `cost`: null if it is not asked for; logarithms are slow.
Equations equations(const SurfacePoints& scan, const SurfaceMap& map, const Pose2& pose,
                    double radius, double sigma, double* cost) {
  Equations e;
  const double c = std::cos(pose.theta), s = std::sin(pose.theta);
  for (const SurfacePoint& p : scan) {
    const SurfacePoint q{pose.x + c * p.x - s * p.y, pose.y + s * p.x + c * p.y,
                         c * p.nx - s * p.ny, s * p.nx + c * p.ny};
    const SurfacePoint* m = map.nearest(q, radius);
    if (m == nullptr) continue;
    // The mean of both normals; without any, the point is left out.
    double nx = m->nx + q.nx, ny = m->ny + q.ny;
    const double length = std::hypot(nx, ny);
    if (!(length > 0.0)) continue;
    nx /= length;
    ny /= length;
    const double r = nx * (q.x - m->x) + ny * (q.y - m->y);
    // In the frame of the pose: d q = R (d + theta x p).
    const double lx = c * nx + s * ny, ly = -s * nx + c * ny;
    const Eigen::Vector3d j(lx, ly, ly * p.x - lx * p.y);
    const double t = r / sigma;
    const double weight = 1.0 / (1.0 + t * t) / (sigma * sigma);  // Cauchy
    e.h += weight * j * j.transpose();
    e.g += weight * r * j;
    e.squares += r * r;
    if (cost != nullptr) *cost += 0.5 * std::log1p(t * t);
    ++e.pairs;
  }
  return e;
}

}  // namespace

void IcpParams::describe(hyselam::ParameterVisitor& visit) {
  visit("max_iterations", max_iterations, Range::atLeast(1), "", "iterations at most");
  visit("initial_distance", initial_distance, Range::above(0.0), "m",
        "maximum distance of corresponding points in the first iteration");
  visit("final_distance", final_distance, Range::above(0.0), "m", "and in the last iterations");
  visit("sigma", sigma, Range::above(0.0), "m", "standard deviation of points from surfaces");
  visit("convergence_threshold", convergence_threshold, Range::above(0.0), "m and rad",
        "a smaller step ends the iteration");
}

void IcpParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(initial_distance >= final_distance)) {
    throw ParameterError("initial_distance", initial_distance, "at least final_distance");
  }
}

IcpResult alignIcp(const SurfacePoints& scan, const SurfaceMap& map, const Pose2& guess,
                   const Eigen::Matrix3d& guess_information, const IcpParams& params) {
  return alignIcpFrom(guess, scan, map, guess, guess_information, params);
}

IcpResult alignIcpFrom(const Pose2& start, const SurfacePoints& scan, const SurfaceMap& map,
                       const Pose2& guess, const Eigen::Matrix3d& guess_information,
                       const IcpParams& params) {
  IcpResult result;
  result.pose = start;
  if (scan.empty() || map.empty()) return result;
  double radius = params.initial_distance;
  for (; result.iterations < params.max_iterations; ++result.iterations) {
    Equations e = equations(scan, map, result.pose, radius, params.sigma, nullptr);
    const Pose2 off = between(guess, result.pose);
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    rotation.topLeftCorner<2, 2>() << std::cos(off.theta), -std::sin(off.theta),
        std::sin(off.theta), std::cos(off.theta);
    e.h += rotation.transpose() * guess_information * rotation;
    e.g += rotation.transpose() * guess_information * Eigen::Vector3d(off.x, off.y, off.theta);
    // A little damping keeps the pose in directions that no surface determines.
    e.h.diagonal().array() += 1e-3;
    const Eigen::Vector3d step = e.h.ldlt().solve(-e.g);
    if (!step.allFinite()) break;
    result.pose = result.pose * Pose2{step[0], step[1], step[2]};
    const bool last = radius <= params.final_distance;
    if (last && step.cwiseAbs().maxCoeff() < params.convergence_threshold) {
      result.converged = true;
      ++result.iterations;
      break;
    }
    radius = std::max(params.final_distance, radius * 0.7);
  }
  const Equations end =
      equations(scan, map, result.pose, params.final_distance, params.sigma, &result.cost);
  result.information = end.h;
  result.matched = static_cast<double>(end.pairs) / static_cast<double>(scan.size());
  result.rms = end.pairs > 0 ? std::sqrt(end.squares / end.pairs) : 0.0;
  const double farthest = params.final_distance / params.sigma;
  result.cost += 0.5 * std::log1p(farthest * farthest) *
                 static_cast<double>(scan.size() - static_cast<std::size_t>(end.pairs));
  return result;
}

}  // namespace hyselam_scan_matching

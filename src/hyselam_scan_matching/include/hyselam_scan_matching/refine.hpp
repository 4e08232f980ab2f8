// The pose from which a scan fits known surfaces best, from a guess nearby: iterated closest points
// against lines.
#pragma once

#include <Eigen/Core>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/surface_map.hpp"

namespace hyselam_scan_matching {

struct RefineParams {
  int max_iterations = 20;    ///< >= 1
  double first_radius = 0.5;  ///< points farther apart are no pair, at first [m], > 0
  double last_radius = 0.15;  ///< and in the end [m], > 0, at most first_radius
  double sigma = 0.03;        ///< deviation of points from surfaces [m], > 0
  double settled = 1e-5;      ///< a step shorter than this ends it [m and rad], > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct Refined {
  hyselam::Pose2 pose;
  /// Inverse covariance of (x, y, theta) of the error in the frame of the refined pose, as the
  /// surfaces tell it, without the guess: nearly singular along a bare corridor.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double matched = 0.0;  ///< part of the scan's points that have a surface in `last_radius`, 0..1
  double rms = 0.0;      ///< distance of these from their surfaces [m]
  int iterations = 0;
  bool converged = false;
};

/// `guess_information`: inverse covariance of the guess in its own frame, zero for no opinion.
/// An empty scan or map gives the guess back with matched = 0.
Refined refine(const SurfacePoints& scan, const SurfaceMap& map, const hyselam::Pose2& guess,
               const Eigen::Matrix3d& guess_information = Eigen::Matrix3d::Zero(),
               const RefineParams& params = {});

}  // namespace hyselam_scan_matching

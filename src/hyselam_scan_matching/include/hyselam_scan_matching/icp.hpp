// Scan alignment by iterated closest points with a point-to-line metric (Censi 2008), from a guess
// nearby.
#pragma once

#include <Eigen/Core>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/surface_map.hpp"

namespace hyselam_scan_matching {

struct IcpParams {
  int max_iterations = 20;        ///< >= 1
  double initial_distance = 0.5;  ///< maximum distance of corresponding points, at first [m], > 0
  double final_distance = 0.15;   ///< and in the end [m], > 0, at most initial_distance
  double sigma = 0.03;            ///< standard deviation of points from surfaces [m], > 0
  double convergence_threshold = 1e-5;  ///< stop at a smaller step [m and rad], > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct IcpResult {
  hyselam::Pose2 pose;
  /// Inverse covariance of the error (x, y, theta) in the frame of `pose`, from the surfaces
  /// without the guess: nearly singular along a bare corridor.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// Inlier ratio: share of the scan's points with a surface within final_distance, 0..1.
  double matched = 0.0;
  double rms = 0.0;  ///< of their distances from the surfaces [m]
  /// Negative logarithm of the likelihood of the scan, up to a constant: points without a surface
  /// within final_distance count as if one were just there. The prior is not in it.
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;
};

/// `guess_information`: inverse covariance of the guess in its own frame, zero for no prior.
/// An empty scan or map returns the guess with matched = 0.
IcpResult alignIcp(const SurfacePoints& scan, const SurfaceMap& map, const hyselam::Pose2& guess,
                   const Eigen::Matrix3d& guess_information = Eigen::Matrix3d::Zero(),
                   const IcpParams& params = {});
/// The same prior, but the iteration begins at `start`: a search found it, the guess stays what
/// odometry says.
IcpResult alignIcpFrom(const hyselam::Pose2& start, const SurfacePoints& scan,
                       const SurfaceMap& map, const hyselam::Pose2& guess,
                       const Eigen::Matrix3d& guess_information, const IcpParams& params = {});

}  // namespace hyselam_scan_matching

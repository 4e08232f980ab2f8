// Where the laser is mounted, by a run itself: its scans against its odometry.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

struct LaserMountParams {
  double min_step = 0.5;     ///< keyframes that are compared are this far apart [m], > 0 ...
  double min_turn = 0.4;     ///< ... or turned by this [rad], > 0
  double min_matched = 0.6;  ///< of the points of a scan, on the surfaces of the other, 0..1
  int max_pairs = 600;       ///< evenly chosen, >= 10
  int min_pairs = 30;        ///< fewer tell nothing, >= 10
  /// A mounting is told wrong if it is off by so many standard deviations and by so much, > 0.
  double significance = 4.0;
  double tolerance = 0.03;        ///< [m]
  double angle_tolerance = 0.02;  ///< [rad]

  void describe(hyselam::ParameterVisitor& visit);
};

/// Where the laser is, in the frame of the base, against where the scans say it is (tf).
struct LaserMount {
  hyselam::Pose2 told, estimated;
  Eigen::Vector3d stddev = Eigen::Vector3d::Zero();  ///< of the estimate [m, m, rad]
  int pairs = 0;                                     ///< of keyframes that were compared
  /// The odometry tells this part of distances and of rotations; > 0.
  double distance_scale = 1.0, rotation_scale = 1.0;
  bool wrong_position = false, wrong_heading = false;  ///< see LaserMountParams

  bool wrong() const { return wrong_position || wrong_heading; }
  /// "the laser is mounted 8 cm to the left and 5.0 deg … of where tf has it".
  std::string text() const;
};

/// The motion of the laser between two keyframes, by their scans without odometry, must be that of
/// the base by its odometry, seen from where the laser is mounted (as in Censi et al. 2013). The
/// scale of the odometry, and a drift of its heading by distance, are estimated too. Nothing if
/// there are too few pairs or the robot never turned. Deterministic.
std::optional<LaserMount> estimateLaserMount(const std::vector<SlamKeyframe>& keyframes,
                                             const LaserMountParams& params = {});

}  // namespace ngram_slam

// Odometry refined by scans: each scan is matched with the surfaces that the last ones saw.
#pragma once

#include <optional>

#include "hyselam_scan_matching/icp.hpp"

namespace hyselam_scan_matching {

struct ScanOdometryParams {
  SurfacePointParams surface;
  IcpParams refine;
  double scan_step = 0.05;  ///< within it of the last match a scan is not matched [m], >= 0
  double scan_turn = 0.03;  ///< [rad], >= 0
  double max_step = 5.0;    ///< a larger step between two scans is a jump of the odometry [m], > 0
  double keyframe_step = 0.25;         ///< distance of the scans that make the local map [m], > 0
  double keyframe_turn = 0.2;          ///< or turn between them [rad], > 0
  int local_map_keyframes = 40;        ///< >= 1
  double local_map_resolution = 0.03;  ///< [m], > 0
  /// Below this share of points on known surfaces the scan is searched around the odometry's pose.
  double min_inlier_ratio = 0.5;
  double search_window = 0.6;  ///< +- along each axis [m], > 0
  double search_angle = 0.35;  ///< +- [rad], 0..pi
  double search_min_score = 0.4;
  double search_min_gain = 0.1;  ///< of the inlier ratio, for what the search found to count
  /// Below this share a match counts for nothing: the odometry is taken as it is.
  double weak_inlier_ratio = 0.4;
  int max_weak_matches = 3;  ///< so many in a row break the track, >= 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The smooth motion of a robot: odometry between scans, corrected by each scan. Its frame, the
/// smooth frame, is that of the odometry at first and drifts from it as the wheels slip. The local
/// map is a SurfaceMap of the last keyframes, not the grid of that name in fsd_localization.
class ScanOdometry {
 public:
  /// What became of a scan.
  struct Step {
    hyselam::Pose2 pose;  ///< of the base, in the smooth frame
    /// The scan was compared with the local map, whether it fits it or not; not where it is near
    /// the last one that was, or shows nothing.
    bool matched = false;
    double inlier_ratio = 1;  ///< IcpResult::matched of that comparison
    /// The motion since the scan before is unknown: the odometry jumped, or several scans in a row
    /// did not fit. The local map begins again with this scan.
    bool broken = false;
  };

  /// @throws hyselam::ParameterError
  explicit ScanOdometry(const ScanOdometryParams& params = {});

  /// @param odometry base pose at the scan's stamp.
  Step add(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  /// Forgets the local map; the next scan begins a new one where the odometry says.
  void reset();

 private:
  void begin(const SurfacePoints& points);
  void addKeyframe(const SurfacePoints& points);
  IcpResult match(const SurfacePoints& points, const hyselam::Pose2& motion);

  ScanOdometryParams params_;
  SurfaceMap local_map_;
  int keyframes_ = 0;             // in the local map
  hyselam::Pose2 keyframe_pose_;  // of the last one
  bool started_ = false;
  int weak_ = 0;  // matches in a row
  struct InVain {
    hyselam::Pose2 pose;
    double inlier_ratio;  // without the search
  };
  std::optional<InVain> searched_in_vain_;          // the last search, if it found nothing better
  hyselam::Pose2 pose_, odometry_;                  // at the last scan
  hyselam::Pose2 matched_pose_, matched_odometry_;  // at the last match
};

}  // namespace hyselam_scan_matching

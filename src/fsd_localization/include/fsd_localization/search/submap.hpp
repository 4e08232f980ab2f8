// What the robot saw over its last metres, joined by its odometry.
#pragma once

#include <deque>
#include <vector>

#include "hyselam_common/laser_scan.hpp"

namespace fsd_localization {

/// Returns of several scans in the frame of the newest pose.
struct Submap {
  /// One scan: where the laser was, and the ends of its beams.
  struct View {
    hyselam::Point2 laser;
    std::vector<hyselam::Point2> ends;
  };
  std::vector<hyselam::Point2> points;  ///< of all scans, thinned to one per 15 cm
  std::vector<View> views;              ///< some scans, evenly spread, thinned to some beams each
  double length = 0.0;                  ///< [m] travelled
  double turned = 0.0;                  ///< [rad], all turns added up
};

/// Keeps the scans of the last metres; cheap to feed.
class SubmapBuilder {
 public:
  static constexpr double kMaxLength = 10.0;  ///< [m]; over more, even refined odometry bends
  static constexpr double kMaxRange = 30.0;   ///< [m] farther returns are left out

  /// @param base in a frame that moves smoothly.
  void add(const hyselam::LaserScan& scan, const hyselam::Pose2& base);
  void reset();
  /// Forgets what was seen farther back than `length` [m]; build() says how that is counted.
  void keepLast(double length, double turn_as_travel);

  bool empty() const { return scans_.empty(); }
  /// Seen from the newest pose, no farther back than `length` [m] of travel. Each radian turned
  /// counts as `turn_as_travel` [m].
  Submap build(double length = kMaxLength, double turn_as_travel = 0.0) const;

 private:
  struct Kept {
    hyselam::Pose2 base;
    double travelled, turned;
    hyselam::Point2 laser;              // in the base frame, as the ends
    std::vector<hyselam::Point2> ends;  // none of the newest, if that is not a step
  };
  /// The number of the first scan no farther back than that.
  std::size_t firstWithin(double length, double turn_as_travel) const;
  static std::vector<hyselam::Point2> endsOf(const hyselam::LaserScan& scan);

  std::deque<Kept> scans_;  // the newest scan always last, the others a step apart
  bool last_is_step_ = true;
  hyselam::LaserScan
      last_scan_;  // the newest, if it is not: most are replaced before they are used
  double travelled_ = 0.0, turned_ = 0.0;
};

}  // namespace fsd_localization

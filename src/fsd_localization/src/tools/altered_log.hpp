// A recorded run in which more happens to the robot than did.
#pragma once

#include <cstddef>
#include <vector>

#include "hyselam_common/robot_log.hpp"

namespace fsd_localization {

struct Alterations {
  /// Times that the robot is carried off: a part of the log, over 30 s long and ending 5 to 25 m
  /// away, is cut out, unknown to the wheels.
  std::size_t kidnaps = 0;
  std::size_t stops = 0;  ///< times that it stops on its way instead
  double stand = 0.0;     ///< [s] that it stands then, in each case
  /// Share of the beams, 0..1, that people hide meanwhile who stand 0.6 m before the laser, side by
  /// side.
  double crowd = 0.0;
};

/// A robot that was made to stand: from its last scan on the way, or its first one after a jump.
struct Stand {
  double begin = 0.0, end = 0.0;  ///< [s]
  bool carried = false;
};

struct AlteredLog {
  hyselam::RobotLog log;  ///< true poses are those of its scans
  std::vector<Stand> stands;
};

/// Stamps are closed up or moved. While the robot stands its scan comes again ten times a second.
AlteredLog altered(const hyselam::RobotLog& log, const std::vector<hyselam::StampedPose2>& truth,
                   const Alterations& alterations);

}  // namespace fsd_localization

// One line of a CARMEN log, taken apart.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hyselam_common/laser_scan.hpp"

namespace hyselam {

struct CarmenLine {
  enum class Kind { kNothing, kScan, kOdometry, kGroundTruth, kLaserOffset, kCorrected };
  Kind kind = Kind::kNothing;
  double ipc_stamp = 0.0;
  double logger_stamp = 0.0;
  // kScan
  std::string message;
  LaserScan scan;                  ///< without stamp; range_max 0 if the line does not state it
  std::optional<Pose2> odometry;   ///< robot pose carried by the scan
  bool states_laser_pose = false;  ///< scan.laser_in_base is given by the line itself
  // kOdometry, kGroundTruth
  Pose2 pose;
  // kLaserOffset
  double laser_offset = 0.0;  ///< [m]
};

/// Takes one line apart; `fields` is scratch space. On failure returns nothing and sets `reason`.
std::optional<CarmenLine> parseCarmenLine(std::string_view line,
                                          std::vector<std::string_view>* fields,
                                          std::string* reason);

}  // namespace hyselam

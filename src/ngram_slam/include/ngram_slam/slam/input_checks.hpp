// What SLAM takes of scans and poses, live and from saved states.
#pragma once

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/pose2.hpp"

namespace ngram_slam {

/// Why the geometry of a scan cannot be used: not finite, all beams with one bearing, a laser more
/// than 5 m from the base. nullptr if it can.
const char* scanError(const hyselam::LaserScan& scan);
/// Why a pose cannot be used: not finite, or |x| or |y| above 9900 km. nullptr if it can.
const char* poseError(const hyselam::Pose2& pose);

}  // namespace ngram_slam

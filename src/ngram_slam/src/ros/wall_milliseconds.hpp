// How long something took.
#pragma once

#include <ros/time.h>

namespace ngram_slam {

/// [ms] of wall time.
inline double millisecondsSince(const ros::WallTime& begin) {
  return 1e3 * (ros::WallTime::now() - begin).toSec();
}

}  // namespace ngram_slam

// Lets something pass at most so often, in the time of the data.
#pragma once

#include <ros/time.h>

namespace fsd_localization {

class RateLimit {
 public:
  /// @param rate [Hz]; -1: everything passes.
  explicit RateLimit(double rate) : period_(rate > 0.0 ? 1.0 / rate : 0.0) {}

  /// Whether enough time lies between `now` and what passed last; then `now` is the last. After a
  /// step back in time everything may pass.
  bool pass(const ros::Time& now) {
    const double elapsed = (now - last_).toSec();
    if (!last_.isZero() && elapsed >= 0.0 && elapsed < period_) return false;
    last_ = now;
    return true;
  }

 private:
  double period_;
  ros::Time last_;
};

}  // namespace fsd_localization

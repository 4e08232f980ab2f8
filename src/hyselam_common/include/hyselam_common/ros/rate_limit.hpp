// At most so many publications per second, in the time of the data.
#pragma once

#include <ros/time.h>

#include <string>

#include "hyselam_common/ros/params.hpp"

namespace hyselam {

class RateLimit {
 public:
  /// @param rate [Hz]; -1: no limit.
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

/// What a rate [Hz] may be: (0, 1000], or -1 for "no limit" or "never".
inline Range rateRange() {
  return Range::aboveUpTo(0.0, 1000.0).orValue(-1.0);
}
/// A rate [Hz] that may be -1 for "no limit" or "never".
/// @throws ParameterError unless it lies in rateRange().
void loadRate(ParamLoader& loader, const std::string& name, double& rate,
              const std::string& meaning);

}  // namespace hyselam

#include "fsd_localization/filter/inlier_monitor.hpp"

#include <algorithm>

namespace fsd_localization {

namespace {
constexpr double kLastMemory = 0.3;   // [m] of motion
constexpr double kFastMemory = 1.0;   // [m]
constexpr double kSlowMemory = 30.0;  // [m]
}  // namespace

void InlierMonitor::reset() {
  *this = InlierMonitor();
}

void InlierMonitor::accept() {
  slow_ = fast_;
}

void InlierMonitor::add(const std::optional<double>& inlier_ratio, double motion) {
  motion_ += motion;
  current_ = inlier_ratio.has_value();
  if (!current_) return;
  better_of_two_ = std::max(newest_, *inlier_ratio);
  newest_ = *inlier_ratio;
  const auto follow = [&](std::optional<double>& average, double memory) {
    const double before = average.value_or(*inlier_ratio);
    average = before + std::min(1.0, motion / memory) * (*inlier_ratio - before);
  };
  follow(last_, kLastMemory);
  follow(fast_, kFastMemory);
  follow(slow_, kSlowMemory);
}

bool InlierMonitor::isUsual(double min_relative) const {
  return last_ && std::max(*last_, better_of_two_) >= min_relative * *slow_;
}

bool InlierMonitor::isOdd(double min_relative) const {
  return current_ && slow_ && newest_ < min_relative * *slow_;
}

bool InlierMonitor::isBelow(double min_ratio, double min_relative) const {
  return current_ && motion_ > kFastMemory &&
         std::max(*fast_, better_of_two_) < std::max(min_ratio, min_relative * *slow_);
}

}  // namespace fsd_localization

#include "fsd_localization/search/standing_watch.hpp"

namespace fsd_localization {

bool StandingWatch::add(double stamp, const std::optional<double>& inlier_ratio, double low,
                        double fits) {
  if (!inlier_ratio) return false;
  const bool says_the_opposite = low_ ? *inlier_ratio >= fits : *inlier_ratio < low;
  if (!says_the_opposite) {
    since_.reset();
    scans_ = 0;
    return false;
  }
  if (!since_) since_ = stamp;
  if (++scans_ < kScans || stamp - *since_ < kSeconds) return false;
  low_ = !low_;
  since_.reset();
  scans_ = 0;
  return true;
}

}  // namespace fsd_localization

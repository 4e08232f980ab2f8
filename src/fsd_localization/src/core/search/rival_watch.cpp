#include "fsd_localization/search/rival_watch.hpp"

#include <algorithm>

#include "fsd_localization/search/place_search.hpp"

namespace fsd_localization {

using hyselam::Pose2;

namespace {
constexpr double kAgain = 0.5;  // [m] between two answers about a rival
}  // namespace

bool RivalWatch::isBetterAgain(const Pose2& place, const Pose2& base_in_odom, double way) {
  if (rival_ && way - rival_->way < kAgain) return false;
  const bool same =
      rival_ && isSamePlace(rival_->place * between(rival_->base_in_odom, base_in_odom), place);
  rival_ = Rival{place, base_in_odom, way};
  return same;
}

double RivalWatch::ownScans(double way, double length) const {
  return rival_ ? std::min(length, way - rival_->way) : length;
}

}  // namespace fsd_localization

#include "fsd_localization/search/followed_places.hpp"

#include <algorithm>

namespace fsd_localization {

using hyselam::Pose2;

FollowedPlaces::Poses::const_iterator FollowedPlaces::find(const Pose2& place,
                                                           const Pose2& base_in_odom) const {
  return std::find_if(odom_in_grid_.begin(), odom_in_grid_.end(),
                      [&](const Pose2& odom) { return isSamePlace(odom * base_in_odom, place); });
}

bool FollowedPlaces::has(const Pose2& place, const Pose2& base_in_odom) const {
  return find(place, base_in_odom) != odom_in_grid_.end();
}

std::vector<std::size_t> FollowedPlaces::follow(const std::vector<Pose2>& places,
                                                const Pose2& base_in_odom) {
  std::vector<std::size_t> added;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Pose2 odom_in_grid = places[i] * base_in_odom.inverse();
    const auto known = find(places[i], base_in_odom) - odom_in_grid_.begin();
    if (known < static_cast<std::ptrdiff_t>(odom_in_grid_.size())) {
      odom_in_grid_[static_cast<std::size_t>(known)] = odom_in_grid;  // odometry drifts
    } else {
      odom_in_grid_.push_back(odom_in_grid);
      added.push_back(i);
    }
  }
  return added;
}

void FollowedPlaces::compare(const std::optional<Pose2>& searched,
                             const std::optional<Pose2>& filtered, double way) {
  if (!searched || !filtered || !isSamePlace(*searched, *filtered)) {
    agreed_from_.reset();
  } else if (!agreed_from_) {
    agreed_from_ = way;
  }
}

std::optional<double> FollowedPlaces::agreedFor(double way) const {
  if (!agreed_from_) return std::nullopt;
  return way - *agreed_from_;
}

}  // namespace fsd_localization

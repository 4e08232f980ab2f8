// The places that the filter follows among which the search cannot decide yet.
#pragma once

#include <optional>
#include <vector>

#include "fsd_localization/search/place_search.hpp"

namespace fsd_localization {

/// A search knows what was seen last, a filter all that was seen since it follows a place. So an
/// answer only adds the places to it that it has not followed: those that died meanwhile stay dead.
/// Places are poses of the robot now, in the grid's frame. Way: see way.hpp.
class FollowedPlaces {
 public:
  /// @param base_in_odom the robot now, in a frame that moves smoothly; as below.
  bool has(const hyselam::Pose2& place, const hyselam::Pose2& base_in_odom) const;
  /// @returns the numbers of the places that were not followed; from now on they are.
  std::vector<std::size_t> follow(const std::vector<hyselam::Pose2>& places,
                                  const hyselam::Pose2& base_in_odom);
  /// Nothing is followed any more.
  void reset() { *this = FollowedPlaces(); }

  /// Tells what search and filter each think the best place; nothing: nothing fits, or the filter
  /// follows no place yet. That agrees with nothing.
  void compare(const std::optional<hyselam::Pose2>& searched,
               const std::optional<hyselam::Pose2>& filtered, double way);
  /// Way since when they have agreed, in each answer told here; nothing if they do not.
  std::optional<double> agreedFor(double way) const;

 private:
  using Poses = std::vector<hyselam::Pose2>;
  Poses::const_iterator find(const hyselam::Pose2& place, const hyselam::Pose2& base_in_odom) const;

  Poses odom_in_grid_;  // of each place: the smooth frame, if the robot is there
  std::optional<double> agreed_from_;
};

}  // namespace fsd_localization

// A place that is better than the tracked pose: one answer of the search alone is not believed.
#pragma once

#include <optional>

#include "hyselam_common/pose2.hpp"

namespace fsd_localization {

/// One answer against a tracked pose may be wrong: scans are joined wrongly in a quick turn, the
/// map is wrong here. So the next must say it again of the same place. Way: see way.hpp.
class RivalWatch {
 public:
  /// [m] of scans that a second answer rests on, all of them seen since the first one: where each
  /// scan fits the map, and only how they are joined speaks against the pose.
  static constexpr double kOwnScans = 1.5;

  /// A place, in the grid's frame, is better than the tracked one.
  /// @param base_in_odom the robot then, in a frame that moves smoothly.
  /// @returns whether the same place was so before, half a metre of the way back or more. What is
  ///   told sooner says nothing; another place begins anew.
  bool isBetterAgain(const hyselam::Pose2& place, const hyselam::Pose2& base_in_odom, double way);
  /// A search has found nothing that is better.
  void reset() { rival_.reset(); }

  bool hasRival() const { return rival_.has_value(); }
  /// Whether it is too early for a second answer of scans of its own; no if there is no rival.
  bool isTooEarly(double way) const { return rival_ && way - rival_->way < kOwnScans; }
  /// The length of scans that such an answer may rest on, of `length` at most [m].
  double ownScans(double way, double length) const;

 private:
  struct Rival {
    hyselam::Pose2 place, base_in_odom;
    double way;
  };
  std::optional<Rival> rival_;
};

}  // namespace fsd_localization

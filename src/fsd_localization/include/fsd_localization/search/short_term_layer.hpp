// What the last scans saw again and again where the map has nothing: furniture that was moved,
// rooms that the map does not know. Only the present has it, so it tells nothing about the place on
// the map.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "hyselam_common/laser_scan.hpp"

namespace fsd_localization {

/// A grid in the smooth frame of the motion. Deterministic.
class ShortTermLayer {
 public:
  static constexpr double kCell = 0.1;   ///< [m]
  static constexpr int kSeen = 3;        ///< returns from which on a thing is known
  static constexpr double kKept = 20.0;  ///< [m] of way that a thing is remembered, up to 5 m more

  /// The returns of a scan in the frame of `base`'s parent, up to `max_range` [m].
  static std::vector<hyselam::Point2> endsOf(const hyselam::LaserScan& scan,
                                             const hyselam::Pose2& base, double max_range);
  /// Takes up what a scan saw of a pose that is trusted. @param on_map whether the map has an
  /// obstacle near each end. @param way of the robot [m].
  void add(const std::vector<hyselam::Point2>& ends, const std::vector<bool>& on_map, double way);
  /// The scan without the returns (NaN) from what only the present has.
  hyselam::LaserScan without(const hyselam::LaserScan& scan, const hyselam::Pose2& base) const;
  void clear() { cells_.clear(); }
  bool empty() const { return cells_.empty(); }

  /// Whether what is there is known, and is not on the map.
  bool isOfThePresent(const hyselam::Point2& at) const;
  /// The middles of the cells with returns of which that holds, in the order of their places.
  std::vector<hyselam::Point2> points() const;

 private:
  struct Seen {
    std::int32_t on_map = 0, off_map = 0;  // returns
    double way = 0.0;                      // [m] when it was seen last
  };
  std::unordered_map<std::uint64_t, Seen> cells_;
  double pruned_at_ = 0.0;  // [m]
};

}  // namespace fsd_localization

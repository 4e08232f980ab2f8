// Searches the map for a submap in a thread of its own.
#pragma once

#include <future>
#include <memory>
#include <optional>

#include "fsd_localization/search/place_search.hpp"

namespace fsd_localization {

/// What a search found, for the pose at the time it was asked.
struct SearchAnswer {
  double stamp = 0.0;             ///< of the newest scan [s]
  hyselam::Pose2 base_in_odom;    ///< of that scan, in the smooth frame of the motion
  double length = 0.0;            ///< of the submap [m]
  std::vector<Place> places;      ///< best first, in the grid's frame
  std::optional<Place> believed;  ///< the pose that was asked about, refined
};

/// One search at a time. An answer counts from `latency` after its question on, by the stamps of
/// scans: so the same run gives the same poses, online and offline, as long as searches take less.
class BackgroundSearch {
 public:
  BackgroundSearch(std::shared_ptr<const PlaceSearch> search, double latency)
      : search_(std::move(search)), latency_(latency) {}

  const PlaceSearch& places() const { return *search_; }
  bool busy() const { return pending_.valid(); }
  /// @param believed pose in the grid's frame that is compared with what is found.
  void ask(double stamp, const hyselam::Pose2& base_in_odom, Submap submap,
           const std::optional<hyselam::Pose2>& believed);
  /// Whether take() may have an answer at this time.
  bool isDue(double stamp) const { return busy() && !dropped_ && stamp >= asked_ + latency_; }
  /// The answer, once it is due. Without `wait` one that is late comes later.
  std::optional<SearchAnswer> take(double stamp, bool wait);
  /// The answer of the search under way is not wanted any more.
  void drop() { dropped_ = busy(); }

 private:
  std::shared_ptr<const PlaceSearch> search_;
  double latency_;  // [s]
  double asked_ = 0.0;
  bool dropped_ = false;
  std::future<SearchAnswer> pending_;
};

}  // namespace fsd_localization

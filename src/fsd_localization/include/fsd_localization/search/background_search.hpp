// Searches the map for a submap in a thread of its own.
#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "fsd_localization/search/place_search.hpp"

namespace fsd_localization {

/// What a search found, for the pose at the time it was asked.
struct SearchAnswer {
  double stamp = 0.0;             ///< of the newest scan [s]
  hyselam::Pose2 base_in_odom;    ///< of that scan, in the smooth frame of the motion
  double length = 0.0;            ///< of the submap [m]
  double turned = 0.0;            ///< in it [rad]
  std::vector<Place> places;      ///< best first, in the grid's frame
  std::optional<Place> believed;  ///< the pose that was asked about, refined
  double blocked = 0.0;           ///< PlaceSearch::blockedShare of it, as it was told
};

/// One search at a time. An answer counts at the first scan that comes `latency` or more after its
/// question, by their stamps, and not before: whoever waits there for it (isLate) gets the same
/// poses from the same run, however busy the machine is.
class BackgroundSearch {
 public:
  BackgroundSearch(std::shared_ptr<const PlaceSearch> search, double latency)
      : search_(std::move(search)), latency_(latency) {}
  ~BackgroundSearch() { drop(); }
  BackgroundSearch(const BackgroundSearch&) = delete;
  BackgroundSearch& operator=(const BackgroundSearch&) = delete;

  const PlaceSearch& places() const { return *search_; }
  bool busy() const { return running_.answer.valid(); }
  /// @param believed pose in the grid's frame that is compared with what is found.
  void ask(double stamp, const hyselam::Pose2& base_in_odom, Submap submap,
           const std::optional<hyselam::Pose2>& believed);
  /// Whether take() may have an answer at this time.
  bool isDue(double stamp) const { return busy() && stamp >= asked_ + latency_; }
  /// Whether an answer is due that has not come.
  bool isLate(double stamp) const;
  /// The answer, once it is due. Without `wait` one that is late comes later.
  std::optional<SearchAnswer> take(double stamp, bool wait);
  /// The answer of the search under way is not wanted any more; another may be asked for at once.
  void drop();

 private:
  struct Running {
    std::shared_ptr<std::atomic<bool>> cancelled;
    std::future<SearchAnswer> answer;
  };
  std::shared_ptr<const PlaceSearch> search_;
  double latency_;  // [s]
  double asked_ = 0.0;
  Running running_;
  std::vector<std::future<SearchAnswer>> ending_;  // dropped, and not yet at their ends
};

}  // namespace fsd_localization

#include "fsd_localization/search/background_search.hpp"

#include <chrono>

namespace fsd_localization {

void BackgroundSearch::ask(double stamp, const hyselam::Pose2& base_in_odom, Submap submap,
                           const std::optional<hyselam::Pose2>& believed) {
  asked_ = stamp;
  dropped_ = false;
  pending_ = std::async(std::launch::async, [search = search_, stamp, base_in_odom, believed,
                                             submap = std::move(submap)] {
    SearchAnswer answer;
    answer.stamp = stamp;
    answer.base_in_odom = base_in_odom;
    answer.length = submap.length;
    answer.places = search->search(submap);
    if (believed) answer.believed = search->refine(submap, *believed);
    return answer;
  });
}

std::optional<SearchAnswer> BackgroundSearch::take(double stamp, bool wait) {
  if (!busy()) return std::nullopt;
  const bool ready = pending_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  if (dropped_) {
    if (!ready && !wait) return std::nullopt;
    pending_.get();
    dropped_ = false;
    return std::nullopt;
  }
  if (!isDue(stamp) || (!ready && !wait)) return std::nullopt;
  return pending_.get();
}

}  // namespace fsd_localization

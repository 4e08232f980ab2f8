#include "fsd_localization/search/background_search.hpp"

#include <algorithm>
#include <chrono>

namespace fsd_localization {

namespace {
bool hasCome(const std::future<SearchAnswer>& answer) {
  return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}
}  // namespace

void BackgroundSearch::ask(double stamp, const hyselam::Pose2& base_in_odom, Submap submap,
                           const std::optional<hyselam::Pose2>& believed) {
  asked_ = stamp;
  drop();
  running_.cancelled = std::make_shared<std::atomic<bool>>(false);
  running_.answer =
      std::async(std::launch::async, [search = search_, stamp, base_in_odom, believed,
                                      cancelled = running_.cancelled, submap = std::move(submap)] {
        SearchAnswer answer;
        answer.stamp = stamp;
        answer.base_in_odom = base_in_odom;
        answer.length = submap.length;
        answer.turned = submap.turned;
        answer.places = search->search(submap, believed, [&] { return cancelled->load(); });
        if (believed) {
          answer.believed = search->refine(submap, *believed);
          answer.blocked = search->blockedShare(submap, *believed);
        }
        return answer;
      });
}

void BackgroundSearch::drop() {
  ending_.erase(std::remove_if(ending_.begin(), ending_.end(), hasCome), ending_.end());
  if (!busy()) return;
  *running_.cancelled = true;
  ending_.push_back(std::move(running_.answer));
}

bool BackgroundSearch::isLate(double stamp) const {
  return isDue(stamp) && !hasCome(running_.answer);
}

std::optional<SearchAnswer> BackgroundSearch::take(double stamp, bool wait) {
  if (!isDue(stamp) || (!wait && !hasCome(running_.answer))) return std::nullopt;
  return running_.answer.get();
}

}  // namespace fsd_localization

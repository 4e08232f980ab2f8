// The last messages of a sensor, to find the one of an image's time.
#pragma once

#include <ros/time.h>

#include <cmath>
#include <cstddef>
#include <deque>
#include <iterator>

namespace selovis {

/// A message that is older than the last by more: time went back, as where a bag begins again [s].
constexpr double kMaxDisorder = 0.5;

/// Messages with a header, in order of time. Not thread safe: for the callbacks of one queue.
template <typename M>
class SensorHistory {
 public:
  /// Keeps the last `capacity` messages, at least 1.
  explicit SensorHistory(std::size_t capacity = 400) : capacity_(capacity) {}

  void add(const typename M::ConstPtr& msg) {
    if (!messages_.empty() &&
        (messages_.back()->header.stamp - msg->header.stamp).toSec() > kMaxDisorder) {
      messages_.clear();
    }
    auto at = messages_.end();
    while (at != messages_.begin() && msg->header.stamp < (*std::prev(at))->header.stamp) --at;
    messages_.insert(at, msg);
    while (messages_.size() > capacity_) messages_.pop_front();
  }
  /// Whether the last message is not older than `stamp`: no later one will be nearer to it.
  bool reaches(const ros::Time& stamp) const {
    return !messages_.empty() && messages_.back()->header.stamp >= stamp;
  }
  /// The message nearest to `stamp`, within `tolerance` [s]; null if there is none.
  typename M::ConstPtr nearest(const ros::Time& stamp, double tolerance) const {
    typename M::ConstPtr best;
    double least = tolerance;
    for (const auto& msg : messages_) {
      const double difference = std::abs((msg->header.stamp - stamp).toSec());
      if (difference <= least) {
        least = difference;
        best = msg;
      }
    }
    return best;
  }

 private:
  std::size_t capacity_;
  std::deque<typename M::ConstPtr> messages_;
};

}  // namespace selovis

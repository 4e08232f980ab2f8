// The last messages of a sensor, to find the one of an image's time.
#pragma once

#include <ros/time.h>

#include <cmath>
#include <cstddef>
#include <deque>
#include <iterator>

namespace selovis {

constexpr double kClockSlack = 0.5;  // [s] older than the last by more: a bag begins again

/// Messages with a header, in order of time. Not thread safe: for the callbacks of one queue.
template <typename M>
class SensorHistory {
 public:
  using Message = M;

  /// Keeps the last `most` messages, at least 1.
  explicit SensorHistory(std::size_t most = 400) : most_(most) {}

  void add(const typename M::ConstPtr& msg) {
    if (!messages_.empty() &&
        (messages_.back()->header.stamp - msg->header.stamp).toSec() > kClockSlack) {
      messages_.clear();  // time went back: a bag begins again
    }
    auto at = messages_.end();
    while (at != messages_.begin() && msg->header.stamp < (*std::prev(at))->header.stamp) --at;
    messages_.insert(at, msg);  // one that is late takes its place
    while (messages_.size() > most_) messages_.pop_front();
  }
  /// Whether a later message can not lie nearer to that time.
  bool reaches(const ros::Time& stamp) const {
    return !messages_.empty() && messages_.back()->header.stamp >= stamp;
  }
  /// The nearest within `tolerance` [s]; null if there is none.
  typename M::ConstPtr nearest(const ros::Time& stamp, double tolerance) const {
    typename M::ConstPtr best;
    double least = tolerance;
    for (const auto& msg : messages_) {
      const double apart = std::abs((msg->header.stamp - stamp).toSec());
      if (apart <= least) {
        least = apart;
        best = msg;
      }
    }
    return best;
  }

 private:
  std::size_t most_;
  std::deque<typename M::ConstPtr> messages_;
};

}  // namespace selovis

// Messages that wait for a result which counts from them on, but not for ever.
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <optional>

namespace hyselam {

/// What is computed in the background counts from a certain message on, so that results do not
/// depend on how busy the machine is. If it is not there when that message comes, the message
/// waits; after `limit` of wall time it goes on without, and so do those behind it until the result
/// is there.
class ResultWait {
 public:
  enum class Verdict {
    kGo,       ///< the result is there, or was given up before
    kWait,     ///< ask again
    kGivenUp,  ///< from now on without it; said once for each result
  };

  /// @param limit [s], not negative.
  explicit ResultWait(double limit) : limit_(limit) {}

  Verdict ask(bool is_there, const ros::WallTime& now) {
    if (is_there) {
      forget();
      return Verdict::kGo;
    }
    if (is_over_) return Verdict::kGo;
    if (!since_) since_ = now;
    if ((now - *since_).toSec() < limit_) return Verdict::kWait;
    is_over_ = true;
    ++given_up_;
    return Verdict::kGivenUp;
  }
  /// The next message may wait again: another map, or time that went back.
  void forget() {
    since_.reset();
    is_over_ = false;
  }
  /// Results that were not waited for to the end.
  std::size_t givenUp() const { return given_up_; }

 private:
  double limit_;
  std::optional<ros::WallTime> since_;
  bool is_over_ = false;
  std::size_t given_up_ = 0;
};

}  // namespace hyselam

// Messages that wait, in order, until a transform of their moment is known; one that waits too long
// is given up, and somebody hears of it.
//
// Why not tf2_ros::MessageFilter: it gives a message up only when its queue overflows or the
// transform has left the buffer, so the last message before tf stops would wait for ever, and
// nobody would be told what is missing while it does. Its messages leave it as their transforms
// come, not in order. And all its frames are asked for at the stamp of the message; here a frame
// that is rigid (base -> laser) is asked for at any time, and what a message waits for need not be
// a transform (another sensor's reading).
#pragma once

#include <ros/node_handle.h>
#include <ros/time.h>
#include <tf2/buffer_core.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <string>
#include <utility>

namespace hyselam {

/// Why `source` cannot be expressed in `target` at `time` (0: the newest that is known):
/// "odom -> base_link at 12.000 s: ..."; empty: it can.
std::string missingTransform(const tf2::BufferCore& tf, const std::string& target,
                             const std::string& source, const ros::Time& time);

struct WaitParams {
  /// Messages that may wait; the oldest is given up first. At least 1.
  std::size_t queue_size = 10;
  /// A message waits at most this long [s].
  double patience = 0.5;
  /// By which clock. Wall time alone: also while the ROS clock stands (a paused bag), messages are
  /// given up. Both: a message is given up when both clocks say so, so that neither a paused bag
  /// nor one played many times too fast loses messages that would find their transforms.
  enum class Clock { kWall, kWallAndRos } clock = Clock::kWallAndRos;
};

/// The queue alone, without a timer: time comes in as an argument. See WaitForTransform.
template <typename Message>
class WaitingQueue {
 public:
  /// What the message still lacks; empty: it can be used now.
  using Missing = std::function<std::string(const Message&)>;
  /// Gets each message that lacks nothing. It has left the queue by then: what this throws leaves
  /// serve(), and the queue goes on with the next message.
  using Use = std::function<void(const Message&)>;
  enum class GivenUp { kQueueFull, kWaitedTooLong };
  /// Gets each message that is given up. @param missing what it lacked (kWaitedTooLong), else
  /// empty.
  using GiveUp = std::function<void(const Message&, GivenUp why, const std::string& missing)>;
  struct Now {
    ros::WallTime wall;
    ros::Time ros;
    static Now read() { return {ros::WallTime::now(), ros::Time::now()}; }
  };

  WaitingQueue(const WaitParams& params, Missing missing, Use use, GiveUp give_up)
      : params_(params),
        missing_(std::move(missing)),
        use_(std::move(use)),
        give_up_(std::move(give_up)) {}

  /// Messages that lack nothing wait, too, as long as `hold` says so of the oldest; they are not
  /// given up for that. Whoever holds them sees to it that it ends.
  void holdWhile(std::function<bool(const Message&)> hold) { hold_ = std::move(hold); }

  void add(Message message, const Now& now) {
    if (waiting_.size() >= params_.queue_size) {
      const Message oldest = takeFirst();
      give_up_(oldest, GivenUp::kQueueFull, "");
    }
    waiting_.push_back({std::move(message), now});
  }

  /// Uses and gives up messages from the oldest on, as far as the first one that has to wait.
  void serve(const Now& now) {
    while (!waiting_.empty()) {
      const std::string missing = missing_(waiting_.front().message);
      const bool ready = missing.empty();
      if (!ready && !waitedTooLong(waiting_.front().since, now)) return;
      if (ready && hold_ && hold_(waiting_.front().message)) return;
      const Message message = takeFirst();
      if (ready) {
        use_(message);
      } else {
        give_up_(message, GivenUp::kWaitedTooLong, missing);
      }
    }
  }

  void clear() { waiting_.clear(); }
  bool empty() const { return waiting_.empty(); }
  std::size_t size() const { return waiting_.size(); }

 private:
  struct Waiting {
    Message message;
    Now since;
  };

  Message takeFirst() {
    Message message = std::move(waiting_.front().message);
    waiting_.pop_front();
    return message;
  }

  bool waitedTooLong(const Now& since, const Now& now) const {
    return (now.wall - since.wall).toSec() >= params_.patience &&
           (params_.clock == WaitParams::Clock::kWall ||
            (now.ros - since.ros).toSec() >= params_.patience);
  }

  const WaitParams params_;
  const Missing missing_;
  const Use use_;
  const GiveUp give_up_;
  std::function<bool(const Message&)> hold_;
  std::deque<Waiting> waiting_;
};

/// A WaitingQueue that tries again by a timer as long as messages wait. Nothing blocks: the other
/// nodelets of a manager are not held up. `Message` is anything that can be copied, best a
/// pointer (sensor_msgs::LaserScan::ConstPtr).
///
/// All functions and callbacks on the queue of the node handle, one at a time. Usage:
///
///     waiting_(nh, {queue_size, patience},
///              [this](const Scan& scan) {
///                return missingTransform(tf_, "odom", "base_link", scan->header.stamp);
///              },
///              [this](const Scan& scan) { process(scan); },
///              [this](const Scan&, auto, const std::string& missing) { count(missing); })
///     ...
///     void onScan(const Scan& scan) { waiting_.add(scan); }
template <typename Message>
class WaitForTransform {
 public:
  using Queue = WaitingQueue<Message>;

  /// Parameters as those of WaitingQueue.
  WaitForTransform(ros::NodeHandle nh, const WaitParams& params, typename Queue::Missing missing,
                   typename Queue::Use use, typename Queue::GiveUp give_up)
      : queue_(params, std::move(missing), std::move(use), std::move(give_up)) {
    constexpr double kRetryEvery = 0.01;  // [s] of wall time
    retry_ = nh.createWallTimer(
        ros::WallDuration(kRetryEvery), [this](const ros::WallTimerEvent&) { serve(); }, false,
        false);
  }
  WaitForTransform(const WaitForTransform&) = delete;  // the timer holds it
  WaitForTransform& operator=(const WaitForTransform&) = delete;

  /// See WaitingQueue.
  void holdWhile(std::function<bool(const Message&)> hold) { queue_.holdWhile(std::move(hold)); }

  /// Queues the message; uses it at once if nothing is missing and none waits before it.
  void add(Message message) {
    queue_.add(std::move(message), Queue::Now::read());
    serve();
  }

  /// Tries now; to be called when something came that messages may wait for.
  void serve() {
    // Also after an exception of a callback the rest goes on waiting.
    struct TimerUpdate {
      WaitForTransform* self;
      ~TimerUpdate() {
        if (self->queue_.empty()) {
          self->retry_.stop();
        } else {
          self->retry_.start();
        }
      }
    } const update{this};
    queue_.serve(Queue::Now::read());
  }

  /// Forgets all that wait, without giving them up one by one (time went back).
  void clear() {
    queue_.clear();
    retry_.stop();
  }
  bool empty() const { return queue_.empty(); }
  std::size_t size() const { return queue_.size(); }

 private:
  Queue queue_;
  ros::WallTimer retry_;
};

}  // namespace hyselam

// Forwards sentences to the node that handles objects (hyselam_objects/ObjectEngine) and
// returns the answers. By topics, not by a service: neither waits in a callback for the other, so
// that one thread is enough for both.
#pragma once

#include <hyselam_msgs/ObjectAnswer.h>
#include <ros/ros.h>

#include <functional>
#include <map>

#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

/// Topics `object_request` and `object_answer`. Callbacks run on the queue of the handle.
class SentenceForwarder {
 public:
  /// The answer to a sentence; nullptr: none within the timeout [s].
  using Answered = std::function<void(const ForwardedSentence&, const hyselam_msgs::ObjectAnswer*)>;

  SentenceForwarder(ros::NodeHandle nh, double timeout, Answered answered);

  /// Whether a node subscribes to `object_request`.
  bool hasListeners() const { return publisher_.getNumSubscribers() > 0; }
  void forward(const ForwardedSentence& sentence);
  /// The other node's question is over: stop, cancel, or something else was said.
  void endQuestion();
  /// Answers that are still to come are not taken any more: stop was said.
  void dropAll() { pending_.clear(); }
  /// Times out overdue requests; to be called periodically.
  void dropOverdue();

 private:
  struct Pending {
    ForwardedSentence sentence;
    ros::WallTime since;
  };

  void onAnswer(const hyselam_msgs::ObjectAnswer::ConstPtr& msg);

  double timeout_;
  Answered answered_;
  std::uint32_t next_id_;
  std::map<std::uint32_t, Pending> pending_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

}  // namespace hyselam_topo

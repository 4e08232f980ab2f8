// Passes sentences on to what knows the objects, as hyselam_objects/ObjectEngine, and brings the
// answers back. By topics, not by a service: neither waits in a callback for the other, so that one
// thread is enough for both.
#pragma once

#include <hyselam_msgs/ObjectAnswer.h>
#include <ros/ros.h>

#include <functional>
#include <map>

#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

/// Topics `object_request` and `object_answer`. Callbacks run on the queue of the handle.
class ObjectTalk {
 public:
  /// What became of a sentence; no answer (nullptr) within the patience [s].
  using Answered = std::function<void(const PassedOn&, const hyselam_msgs::ObjectAnswer*)>;

  ObjectTalk(ros::NodeHandle nh, double patience, Answered answered);

  /// Whether somebody listens.
  bool isThere() const { return publisher_.getNumSubscribers() > 0; }
  void pass(const PassedOn& sentence);
  /// Gives those up that were passed on too long ago. To be called now and then.
  void giveUp();

 private:
  struct Pending {
    PassedOn sentence;
    ros::WallTime since;
  };

  void onAnswer(const hyselam_msgs::ObjectAnswer::ConstPtr& msg);

  double patience_;
  Answered answered_;
  std::uint32_t next_id_;
  std::map<std::uint32_t, Pending> pending_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

}  // namespace hyselam_topo

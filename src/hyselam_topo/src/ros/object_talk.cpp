#include "hyselam_topo/ros/object_talk.hpp"

#include <hyselam_msgs/ObjectRequest.h>

#include <vector>

namespace hyselam_topo {

ObjectTalk::ObjectTalk(ros::NodeHandle nh, double patience, Answered answered)
    : patience_(patience),
      answered_(std::move(answered)),
      // Answers to somebody before it, or beside it, are not taken for its own.
      next_id_(static_cast<std::uint32_t>(ros::WallTime::now().toNSec() / 1000)) {
  publisher_ = nh.advertise<hyselam_msgs::ObjectRequest>("object_request", 20);
  subscriber_ = nh.subscribe("object_answer", 20, &ObjectTalk::onAnswer, this);
}

void ObjectTalk::pass(const PassedOn& sentence) {
  hyselam_msgs::ObjectRequest msg;
  msg.id = next_id_++;
  msg.text = sentence.text;
  pending_[msg.id] = {sentence, ros::WallTime::now()};
  publisher_.publish(msg);
}

void ObjectTalk::onAnswer(const hyselam_msgs::ObjectAnswer::ConstPtr& msg) {
  const auto found = pending_.find(msg->id);
  if (found == pending_.end()) return;  // too late, or not for us
  const PassedOn sentence = found->second.sentence;
  pending_.erase(found);
  answered_(sentence, msg.get());
}

void ObjectTalk::giveUp() {
  const ros::WallTime now = ros::WallTime::now();
  std::vector<PassedOn> late;
  for (auto each = pending_.begin(); each != pending_.end();) {
    if ((now - each->second.since).toSec() < patience_) {
      ++each;
      continue;
    }
    late.push_back(each->second.sentence);
    each = pending_.erase(each);
  }
  for (const PassedOn& sentence : late) answered_(sentence, nullptr);
}

}  // namespace hyselam_topo

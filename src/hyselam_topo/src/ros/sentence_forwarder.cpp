#include "hyselam_topo/ros/sentence_forwarder.hpp"

#include <hyselam_msgs/ObjectRequest.h>

#include <vector>

namespace hyselam_topo {

SentenceForwarder::SentenceForwarder(ros::NodeHandle nh, double timeout, Answered answered)
    : timeout_(timeout),
      answered_(std::move(answered)),
      // Answers to somebody before it, or beside it, are not taken for its own.
      next_id_(static_cast<std::uint32_t>(ros::WallTime::now().toNSec() / 1000)) {
  publisher_ = nh.advertise<hyselam_msgs::ObjectRequest>("object_request", 20);
  subscriber_ = nh.subscribe("object_answer", 20, &SentenceForwarder::onAnswer, this);
}

void SentenceForwarder::forward(const ForwardedSentence& sentence) {
  hyselam_msgs::ObjectRequest msg;
  msg.id = next_id_++;
  msg.text = sentence.text;
  pending_[msg.id] = {sentence, ros::WallTime::now()};
  publisher_.publish(msg);
}

void SentenceForwarder::endQuestion() {
  hyselam_msgs::ObjectRequest msg;
  msg.id = next_id_++;
  msg.end_question = 1;
  publisher_.publish(msg);
}

void SentenceForwarder::onAnswer(const hyselam_msgs::ObjectAnswer::ConstPtr& msg) {
  const auto found = pending_.find(msg->id);
  if (found == pending_.end()) return;  // too late, or not for us
  const ForwardedSentence sentence = found->second.sentence;
  pending_.erase(found);
  answered_(sentence, msg.get());
}

void SentenceForwarder::dropOverdue() {
  const ros::WallTime now = ros::WallTime::now();
  std::vector<ForwardedSentence> late;
  for (auto each = pending_.begin(); each != pending_.end();) {
    if ((now - each->second.since).toSec() < timeout_) {
      ++each;
      continue;
    }
    late.push_back(each->second.sentence);
    each = pending_.erase(each);
  }
  for (const ForwardedSentence& sentence : late) answered_(sentence, nullptr);
}

}  // namespace hyselam_topo

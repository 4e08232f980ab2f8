#include <gtest/gtest.h>
#include <nodelet/detail/callback_queue.h>
#include <nodelet/detail/callback_queue_manager.h>
#include <ros/callback_queue.h>

#include <boost/make_shared.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"

namespace {

struct Counter : ros::CallbackInterface {
  explicit Counter(int& counted) : calls(counted) {}
  CallResult call() override {
    ++calls;
    return Success;
  }
  int& calls;
};

// As the loader of nodelet 1.10.0 makes and closes it; no threads of the manager take from it,
// since it is not added.
struct LoadersQueue {
  nodelet::detail::CallbackQueueManager manager{1};
  boost::shared_ptr<nodelet::detail::CallbackQueue> queue =
      boost::make_shared<nodelet::detail::CallbackQueue>(&manager);
};

TEST(ServerNodelet, WhatComesDuringInitIsKeptInAQueueThatTheLoaderClosed) {
  int calls = 0;
  LoadersQueue loaders;
  loaders.queue->disable();
  ros::CallbackQueueInterface& queue = *loaders.queue;
  queue.addCallback(boost::make_shared<Counter>(calls));
  hyselam::receiveDuringInit(queue);
  EXPECT_NE(loaders.queue->callOne(), ros::CallbackQueue::Called)
      << "the loader's queue was not closed";
  queue.addCallback(boost::make_shared<Counter>(calls));
  EXPECT_EQ(loaders.queue->callOne(), ros::CallbackQueue::Called);
  EXPECT_EQ(calls, 1);
}

TEST(ServerNodelet, AnotherQueueIsLeftAsItIs) {
  ros::CallbackQueue queue;
  queue.disable();
  hyselam::receiveDuringInit(queue);
  EXPECT_FALSE(queue.isEnabled());
}

}  // namespace

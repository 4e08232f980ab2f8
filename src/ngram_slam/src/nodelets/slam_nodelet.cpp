#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "ngram_slam/ros/slam_server.hpp"

namespace ngram_slam {

/// Scans come through the nodelet's single-threaded queue.
class SlamNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<SlamServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<SlamServer> server_;
};

}  // namespace ngram_slam

PLUGINLIB_EXPORT_CLASS(ngram_slam::SlamNodelet, nodelet::Nodelet)

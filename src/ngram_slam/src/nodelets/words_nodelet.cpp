#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "ngram_slam/ros/words_server.hpp"

namespace ngram_slam {

/// All callbacks come through the nodelet's single-threaded queue.
class WordsNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<WordsServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<WordsServer> server_;
};

}  // namespace ngram_slam

PLUGINLIB_EXPORT_CLASS(ngram_slam::WordsNodelet, nodelet::Nodelet)

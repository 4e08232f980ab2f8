#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "fsd_localization/ros/fsd_server.hpp"

namespace fsd_localization {

/// All callbacks come through the nodelet's single-threaded queue.
class FsdNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<FsdServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<FsdServer> server_;
};

}  // namespace fsd_localization

PLUGINLIB_EXPORT_CLASS(fsd_localization::FsdNodelet, nodelet::Nodelet)

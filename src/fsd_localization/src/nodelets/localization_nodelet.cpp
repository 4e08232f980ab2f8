#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "fsd_localization/ros/localization_server.hpp"

namespace fsd_localization {

/// All callbacks come through the nodelet's single-threaded queue.
class LocalizationNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<LocalizationServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<LocalizationServer> server_;
};

}  // namespace fsd_localization

PLUGINLIB_EXPORT_CLASS(fsd_localization::LocalizationNodelet, nodelet::Nodelet)

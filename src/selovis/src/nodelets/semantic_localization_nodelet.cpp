#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "selovis/ros/semantic_localization_server.hpp"

namespace selovis {

/// All callbacks come through the nodelet's single-threaded queue.
class SemanticLocalizationNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ =
          std::make_unique<SemanticLocalizationServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<SemanticLocalizationServer> server_;
};

}  // namespace selovis

PLUGINLIB_EXPORT_CLASS(selovis::SemanticLocalizationNodelet, nodelet::Nodelet)

#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "hyselam_objects/ros/object_engine_server.hpp"

namespace hyselam_objects {

/// All callbacks come through the nodelet's single-threaded queue.
class ObjectEngineNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<ObjectEngineServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<ObjectEngineServer> server_;
};

}  // namespace hyselam_objects

PLUGINLIB_EXPORT_CLASS(hyselam_objects::ObjectEngineNodelet, nodelet::Nodelet)

#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "hyselam_topo/ros/topo_engine_server.hpp"

namespace hyselam_topo {

/// All callbacks come through the nodelet's single-threaded queue.
class TopoEngineNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<TopoEngineServer>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<TopoEngineServer> server_;
};

}  // namespace hyselam_topo

PLUGINLIB_EXPORT_CLASS(hyselam_topo::TopoEngineNodelet, nodelet::Nodelet)

#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "../ros/dynamic_parameters.hpp"
#include "hyselam_topo/ros/gr2to_server.hpp"

namespace hyselam_topo {

/// All callbacks come through the nodelet's single-threaded queue.
class Gr2ToNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ = std::make_unique<Gr2ToServer>(getNodeHandle(), getPrivateNodeHandle());
      dynamic_ = makeDynamicParameters(getPrivateNodeHandle(), server_.get());
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<Gr2ToServer> server_;
  std::shared_ptr<void> dynamic_;
};

}  // namespace hyselam_topo

PLUGINLIB_EXPORT_CLASS(hyselam_topo::Gr2ToNodelet, nodelet::Nodelet)

#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "hyselam_map_server/map_server.hpp"

namespace hyselam_map_server {

class MapServerNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      server_ =
          std::make_unique<MapServer>(getNodeHandle(), loadParameters(getPrivateNodeHandle()));
    } catch (const std::exception& error) {
      // The loader takes what leaves onInit as "did not load" and its manager lives on.
      NODELET_FATAL_STREAM("not loaded: " << error.what());
      throw;
    }
  }

  std::unique_ptr<MapServer> server_;
};

}  // namespace hyselam_map_server

PLUGINLIB_EXPORT_CLASS(hyselam_map_server::MapServerNodelet, nodelet::Nodelet)

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "../ros/dynamic_parameters.hpp"
#include "hyselam_common/ros/server_nodelet.hpp"
#include "hyselam_topo/ros/gr2to_server.hpp"

namespace hyselam_topo {

class Gr2ToNodelet : public hyselam::ServerNodelet<Gr2ToServer> {
  void onServer(Gr2ToServer& server) override {
    dynamic_ = makeDynamicParameters(getPrivateNodeHandle(), &server);
  }

  std::shared_ptr<void> dynamic_;
};

}  // namespace hyselam_topo

PLUGINLIB_EXPORT_CLASS(hyselam_topo::Gr2ToNodelet, nodelet::Nodelet)

#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "hyselam_topo/ros/topo_engine_server.hpp"

namespace hyselam_topo {
class TopoEngineNodelet : public hyselam::ServerNodelet<TopoEngineServer> {};
}  // namespace hyselam_topo

PLUGINLIB_EXPORT_CLASS(hyselam_topo::TopoEngineNodelet, nodelet::Nodelet)

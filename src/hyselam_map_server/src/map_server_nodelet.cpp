#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "hyselam_map_server/map_server.hpp"

namespace hyselam_map_server {
class MapServerNodelet : public hyselam::ServerNodelet<MapServer> {};
}  // namespace hyselam_map_server

PLUGINLIB_EXPORT_CLASS(hyselam_map_server::MapServerNodelet, nodelet::Nodelet)

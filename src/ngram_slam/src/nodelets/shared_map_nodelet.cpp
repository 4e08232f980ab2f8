#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "ngram_slam/ros/shared_map_server.hpp"

namespace ngram_slam {
class SharedMapNodelet : public hyselam::ServerNodelet<SharedMapServer> {};
}  // namespace ngram_slam

PLUGINLIB_EXPORT_CLASS(ngram_slam::SharedMapNodelet, nodelet::Nodelet)

#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "ngram_slam/ros/slam_server.hpp"

namespace ngram_slam {
class SlamNodelet : public hyselam::ServerNodelet<SlamServer> {};
}  // namespace ngram_slam

PLUGINLIB_EXPORT_CLASS(ngram_slam::SlamNodelet, nodelet::Nodelet)

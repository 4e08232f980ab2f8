#include <pluginlib/class_list_macros.hpp>

#include "fsd_localization/ros/fsd_server.hpp"
#include "hyselam_common/ros/server_nodelet.hpp"

namespace fsd_localization {
class FsdNodelet : public hyselam::ServerNodelet<FsdServer> {};
}  // namespace fsd_localization

PLUGINLIB_EXPORT_CLASS(fsd_localization::FsdNodelet, nodelet::Nodelet)

#include <pluginlib/class_list_macros.hpp>

#include "fsd_localization/ros/localization_server.hpp"
#include "hyselam_common/ros/server_nodelet.hpp"

namespace fsd_localization {
class LocalizationNodelet : public hyselam::ServerNodelet<LocalizationServer> {};
}  // namespace fsd_localization

PLUGINLIB_EXPORT_CLASS(fsd_localization::LocalizationNodelet, nodelet::Nodelet)

#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "selovis/ros/semantic_localization_server.hpp"

namespace selovis {
class SemanticLocalizationNodelet : public hyselam::ServerNodelet<SemanticLocalizationServer> {};
}  // namespace selovis

PLUGINLIB_EXPORT_CLASS(selovis::SemanticLocalizationNodelet, nodelet::Nodelet)

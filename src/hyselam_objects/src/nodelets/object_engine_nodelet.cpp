#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "hyselam_objects/ros/object_engine_server.hpp"

namespace hyselam_objects {
class ObjectEngineNodelet : public hyselam::ServerNodelet<ObjectEngineServer> {};
}  // namespace hyselam_objects

PLUGINLIB_EXPORT_CLASS(hyselam_objects::ObjectEngineNodelet, nodelet::Nodelet)

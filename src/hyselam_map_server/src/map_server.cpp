#include "hyselam_map_server/map_server.hpp"

#include <nav_msgs/MapMetaData.h>

#include <fstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/params.hpp"

namespace hyselam_map_server {

namespace {

nav_msgs::OccupancyGrid read(const std::string& file, const std::string& frame_id) {
  nav_msgs::OccupancyGrid map = hyselam::toMsg(hyselam::loadMap(file), frame_id, ros::Time::now());
  map.info.map_load_time = map.header.stamp;
  return map;
}

}  // namespace

void MapServerParams::describe(hyselam::ParameterVisitor& visit) {
  visit("yaml_filename", yaml_filename, "map_server YAML file");
  visit("frame_id", frame_id, "frame of the map");
}

MapServerParams loadParams(const ros::NodeHandle& private_nh, const std::string& file_argument) {
  MapServerParams params;
  hyselam::ParamLoader loader(private_nh);
  params.describe(loader);
  loader.logWarnings();
  if (!file_argument.empty()) params.yaml_filename = file_argument;
  const std::string where = private_nh.getNamespace() + "/";
  if (params.yaml_filename.empty()) {
    throw hyselam::ParameterError(where + "yaml_filename", "empty",
                                  "the path of a map's YAML file");
  }
  if (params.frame_id.empty()) {
    throw hyselam::ParameterError(where + "frame_id", "empty", "the name of a frame");
  }
  return params;
}

MapServer::MapServer(ros::NodeHandle nh, const MapServerParams& params) : params_(params) {
  const nav_msgs::OccupancyGrid map = read(params.yaml_filename, params.frame_id);
  map_publisher_ = nh.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
  metadata_publisher_ = nh.advertise<nav_msgs::MapMetaData>("map_metadata", 1, true);
  use(map);
  static_map_service_ = nh.advertiseService<nav_msgs::GetMap::Request, nav_msgs::GetMap::Response>(
      "static_map", [this](nav_msgs::GetMap::Request&, nav_msgs::GetMap::Response& response) {
        response.map = map_;
        return true;
      });
#ifdef HYSELAM_HAVE_LOAD_MAP
  change_map_service_ = nh.advertiseService("change_map", &MapServer::changeMap, this);
#else
  ROS_WARN("no service change_map: it needs nav_msgs 1.13.1 or newer, for LoadMap");
#endif
}

void MapServer::use(const nav_msgs::OccupancyGrid& map) {
  map_ = map;
  map_publisher_.publish(map_);
  metadata_publisher_.publish(map_.info);
  ROS_INFO_STREAM("map of " << map_.info.width << " x " << map_.info.height << " cells of "
                            << map_.info.resolution << " m in frame " << map_.header.frame_id);
}

#ifdef HYSELAM_HAVE_LOAD_MAP
bool MapServer::changeMap(nav_msgs::LoadMap::Request& request,
                          nav_msgs::LoadMap::Response& response) {
  try {
    use(read(request.map_url, params_.frame_id));
    response.map = map_;
    response.result = nav_msgs::LoadMap::Response::RESULT_SUCCESS;
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM("the map stays as it was: " << error.what());
    response.result = std::ifstream(request.map_url).good()
                          ? nav_msgs::LoadMap::Response::RESULT_INVALID_MAP_DATA
                          : nav_msgs::LoadMap::Response::RESULT_MAP_DOES_NOT_EXIST;
  }
  return true;
}
#endif

}  // namespace hyselam_map_server

// A map file on the ROS interface of map_server, which Debian does not have.
#pragma once

#include <nav_msgs/GetMap.h>
#include <ros/ros.h>

// nav_msgs has LoadMap since 1.13.1, of January 2021. An older one leaves `change_map` out.
#if __has_include(<nav_msgs/LoadMap.h>)
#include <nav_msgs/LoadMap.h>
#define HYSELAM_HAVE_LOAD_MAP
#endif

#include <string>

#include "hyselam_common/parameters.hpp"

namespace hyselam_map_server {

struct MapServerParams {
  std::string yaml_filename;     ///< map_server YAML file
  std::string frame_id = "map";  ///< frame of the published map

  void describe(hyselam::ParameterVisitor& visit);
};

/// Reads ~yaml_filename and ~frame_id. `file_argument`, if not empty, is the file instead.
/// @throws hyselam::ParameterError if there is no file or the frame is empty.
MapServerParams loadParams(const ros::NodeHandle& private_nh,
                           const std::string& file_argument = "");

/// Publishes `map` and `map_metadata` (latched) and serves `static_map` and, where nav_msgs has
/// LoadMap, `change_map`.
/// If `change_map` cannot load a map, the response says so and the present map stays.
class MapServer {
 public:
  /// @throws hyselam::InputError if the file cannot be used; nothing is advertised then.
  MapServer(ros::NodeHandle nh, const MapServerParams& params);
  /// With the parameters that `private_nh` has.
  MapServer(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : MapServer(nh, loadParams(private_nh)) {}

 private:
  void use(const nav_msgs::OccupancyGrid& map);
#ifdef HYSELAM_HAVE_LOAD_MAP
  bool changeMap(nav_msgs::LoadMap::Request& request, nav_msgs::LoadMap::Response& response);
#endif

  MapServerParams params_;
  nav_msgs::OccupancyGrid map_;
  ros::Publisher map_publisher_, metadata_publisher_;
  ros::ServiceServer static_map_service_, change_map_service_;
};

}  // namespace hyselam_map_server

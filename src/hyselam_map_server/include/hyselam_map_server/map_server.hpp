// A map file on the ROS interface of map_server, which Debian does not have.
#pragma once

#include <nav_msgs/GetMap.h>
#include <nav_msgs/LoadMap.h>
#include <ros/ros.h>

#include <string>

namespace hyselam_map_server {

struct MapServerParameters {
  std::string yaml_filename;     ///< map_server YAML file
  std::string frame_id = "map";  ///< frame of the published map
};

/// Reads ~yaml_filename and ~frame_id. `file_argument`, if not empty, is the file instead.
/// Throws hyselam::ParameterError if there is no file or the frame is empty.
MapServerParameters loadParameters(const ros::NodeHandle& private_nh,
                                   const std::string& file_argument = "");

/// Publishes `map` and `map_metadata` (latched) and serves `static_map` and `change_map`.
/// A map that `change_map` cannot load is refused in the answer; the map before stays.
class MapServer {
 public:
  /// Throws hyselam::InputError if the file cannot be used; nothing is advertised then.
  MapServer(ros::NodeHandle nh, const MapServerParameters& parameters);
  /// With the parameters that `private_nh` has.
  MapServer(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
      : MapServer(nh, loadParameters(private_nh)) {}

 private:
  void use(const nav_msgs::OccupancyGrid& map);
  bool changeMap(nav_msgs::LoadMap::Request& request, nav_msgs::LoadMap::Response& response);

  MapServerParameters parameters_;
  nav_msgs::OccupancyGrid map_;
  ros::Publisher map_publisher_, metadata_publisher_;
  ros::ServiceServer static_map_service_, change_map_service_;
};

}  // namespace hyselam_map_server

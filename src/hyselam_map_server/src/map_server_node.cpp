// map_server_node [MAP.yaml]: the map server as a node of its own. Exit 2 if the map cannot be
// used.
#include <iostream>
#include <string>

#include "hyselam_map_server/map_server.hpp"

int main(int argc, char** argv) {
  // Before anything waits for a master.
  if (argc > 1 && (argv[1] == std::string("--help") || argv[1] == std::string("-h"))) {
    std::cout << "Serves a map: topics map and map_metadata, services static_map and change_map.\n"
                 "usage: map_server_node [MAP.yaml] [_yaml_filename:=MAP.yaml] [_frame_id:=map]\n";
    return 0;
  }
  ros::init(argc, argv, "map_server");  // takes the remappings out of argv
  try {
    const ros::NodeHandle private_nh("~");
    const hyselam_map_server::MapServer server(
        ros::NodeHandle(), hyselam_map_server::loadParams(private_nh, argc > 1 ? argv[1] : ""));
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

// The server of the nodelet hyselam_objects/ObjectEngine as a node of its own. Exit 2 if a
// parameter or a file cannot be used.
#include <iostream>

#include "hyselam_objects/ros/object_engine_server.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "object_engine");
  try {
    hyselam_objects::ObjectEngineServer server(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

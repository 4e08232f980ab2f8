// The server of the nodelet fsd_localization/Localization as a node of its own. Exit 2 if a
// parameter cannot be used.
#include <iostream>

#include "fsd_localization/ros/localization_server.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "localization");
  try {
    const fsd_localization::LocalizationServer server(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

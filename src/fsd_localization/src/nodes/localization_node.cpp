// The server of the nodelet fsd_localization/Localization as a node of its own. Exit 2 if a
// parameter cannot be used.
#include <iostream>

#include "../ros/dynamic_parameters.hpp"
#include "fsd_localization/ros/localization_server.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "localization");
  try {
    const ros::NodeHandle private_nh("~");
    fsd_localization::LocalizationServer server(ros::NodeHandle(), private_nh);
    const auto dynamic = fsd_localization::makeDynamicParameters(private_nh, &server);
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

// The server of the nodelet selovis/SemanticLocalization as a node of its own. Exit 2 if a
// parameter or the model cannot be used.
#include <iostream>

#include "selovis/ros/semantic_localization_server.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "semantic_localization");
  try {
    const selovis::SemanticLocalizationServer server(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

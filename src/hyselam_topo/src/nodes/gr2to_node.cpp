// The server of the nodelet hyselam_topo/Gr2To as a node of its own. Exit 2 if a parameter cannot
// be used.
#include <iostream>

#include "../ros/dynamic_parameters.hpp"
#include "hyselam_topo/ros/gr2to_server.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "gr2to");
  try {
    const ros::NodeHandle private_nh("~");
    hyselam_topo::Gr2ToServer server(ros::NodeHandle(), private_nh);
    const auto dynamic = hyselam_topo::makeDynamicParameters(private_nh, &server);
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

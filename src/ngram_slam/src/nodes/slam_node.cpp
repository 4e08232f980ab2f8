// The server of the nodelet ngram_slam/NgramSlam as a node of its own. Exit 2 if a parameter or the
// state cannot be used.
#include <iostream>

#include "ngram_slam/ros/slam_server.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "slam");
  try {
    const ngram_slam::SlamServer server(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

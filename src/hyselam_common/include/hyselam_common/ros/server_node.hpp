// A server as a node of its own.
#pragma once

#include <ros/ros.h>

#include <exception>
#include <iostream>

namespace hyselam {

/// The main function of a node that is one server. Returns 2, with one line on stderr, when the
/// server cannot be made of its parameters and files.
template <typename Server>
int runServer(int argc, char** argv, const char* name) {
  ros::init(argc, argv, name);
  try {
    Server server{ros::NodeHandle(), ros::NodeHandle("~")};
    ros::spin();
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 2;
  }
  return 0;
}

}  // namespace hyselam

// The server of the nodelet ngram_slam/NgramSlam as a node of its own. Exit 2 if a parameter or the
// state cannot be used.
#include "hyselam_common/ros/server_node.hpp"
#include "ngram_slam/ros/slam_server.hpp"

int main(int argc, char** argv) {
  return hyselam::runServer<ngram_slam::SlamServer>(argc, argv, "slam");
}

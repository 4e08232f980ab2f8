// The server of the nodelet ngram_slam/SharedMap as a node of its own. Exit 2 if a parameter cannot
// be used.
#include "hyselam_common/ros/server_node.hpp"
#include "ngram_slam/ros/shared_map_server.hpp"

int main(int argc, char** argv) {
  return hyselam::runServer<ngram_slam::SharedMapServer>(argc, argv, "shared_map");
}

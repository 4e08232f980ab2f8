// The server of the nodelet fsd_localization/Fsd as a node of its own. Exit 2 if a parameter cannot
// be used.
#include "fsd_localization/ros/fsd_server.hpp"
#include "hyselam_common/ros/server_node.hpp"

int main(int argc, char** argv) {
  return hyselam::runServer<fsd_localization::FsdServer>(argc, argv, "fsd");
}

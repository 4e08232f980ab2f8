// The server of the nodelet hyselam_objects/ObjectEngine as a node of its own. Exit 2 if a
// parameter or a file cannot be used.
#include "hyselam_common/ros/server_node.hpp"
#include "hyselam_objects/ros/object_engine_server.hpp"

int main(int argc, char** argv) {
  return hyselam::runServer<hyselam_objects::ObjectEngineServer>(argc, argv, "object_engine");
}

// The server of the nodelet selovis/SemanticLocalization as a node of its own. Exit 2 if a
// parameter or the model cannot be used.
#include "hyselam_common/ros/server_node.hpp"
#include "selovis/ros/semantic_localization_server.hpp"

int main(int argc, char** argv) {
  return hyselam::runServer<selovis::SemanticLocalizationServer>(argc, argv,
                                                                 "semantic_localization");
}

// The server of the nodelet ngram_slam/Words as a node of its own. Exit 2 if a parameter or the
// corpus cannot be used.
#include "hyselam_common/ros/server_node.hpp"
#include "ngram_slam/ros/words_server.hpp"

int main(int argc, char** argv) {
  return hyselam::runServer<ngram_slam::WordsServer>(argc, argv, "words");
}

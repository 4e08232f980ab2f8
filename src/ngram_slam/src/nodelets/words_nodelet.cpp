#include <pluginlib/class_list_macros.hpp>

#include "hyselam_common/ros/server_nodelet.hpp"
#include "ngram_slam/ros/words_server.hpp"

namespace ngram_slam {
class WordsNodelet : public hyselam::ServerNodelet<WordsServer> {};
}  // namespace ngram_slam

PLUGINLIB_EXPORT_CLASS(ngram_slam::WordsNodelet, nodelet::Nodelet)

// The graph of a SLAM as messages, by which robots share their maps.
#pragma once

#include <hyselam_msgs/SlamGraph.h>

#include <string>

#include "ngram_slam/slam/told_graph.hpp"

namespace ngram_slam {

GraphQuestion fromMsg(const hyselam_msgs::SlamGraph::Request& msg);
void toMsg(const GraphQuestion& question, hyselam_msgs::SlamGraph::Request* msg);
/// All but the frame.
void toMsg(const GraphPart& part, hyselam_msgs::SlamGraph::Response* msg);
/// @throws hyselam::InputError, beginning with `source`, for numbers that are not finite or out of
/// range; whether it fits what was told before says ToldGraph::add().
GraphPart fromMsg(const hyselam_msgs::SlamGraph::Response& msg, const std::string& source);

}  // namespace ngram_slam

#include "ngram_slam/ros/shared_map_parameters.hpp"

#include <ros/names.h>

#include <set>
#include <sstream>

#include "drawn_map.hpp"
#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::ParameterError;
using hyselam::Range;

SharedMapServerParams::SharedMapServerParams() {
  map.max_cells = kMostMapCells;
}

std::vector<std::string> SharedMapServerParams::names() const {
  std::vector<std::string> names;
  std::istringstream in(robots);
  for (std::string name; in >> name;) names.push_back(name);
  return names;
}

void SharedMapServerParams::describe(hyselam::ParameterVisitor& visit) {
  visit("robots", robots, "namespaces of their SLAM, separated by spaces; at least two");
  visit("global_frame_id", global_frame_id, "frame of the shared map");
  visit("poll_period", poll_period, Range::between(0.05, 3600.0), "s",
        "of wall time between questions to a robot");
  visit("answer_timeout", answer_timeout, Range::between(0.1, 3600.0), "s",
        "of wall time after which a robot that was asked is told not to answer");
  visit("map_update_interval", map_update_interval, Range::between(0.1, 3600.0), "s",
        "of wall time between maps, if something is new");
  visit("merge_interval", merge_interval, Range::between(0.0, 3600.0), "s",
        "of wall time from the end of a search for ties to the next one, at least");
  visit("max_load", max_load, Range::aboveUpTo(0.0, 1.0), "",
        "part of a core that the searches take on average, and drawing besides");
  visit("transform_publish_period", transform_publish_period, Range::between(0.01, 10.0), "s",
        "of wall time between transforms");
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s",
        "of wall time between diagnostics and statuses");
  describeDrawnMap(map, visit);
  visit.group("", shared);
}

void SharedMapServerParams::validate() const {
  hyselam::checkParameters(*this);
  shared.validate();
  const std::vector<std::string> all = names();
  if (all.size() < 2 || std::set<std::string>(all.begin(), all.end()).size() < all.size()) {
    throw ParameterError("robots", "'" + robots + "'", "at least two names, each another one");
  }
  for (const std::string& name : all) {
    std::string reason;
    if (!ros::names::validate(name, reason)) {
      throw ParameterError("robots", "'" + name + "'", "names of namespaces: " + reason);
    }
    if (name.find('~') != std::string::npos) {
      throw ParameterError("robots", "'" + name + "'", "names of namespaces, which have no '~'");
    }
  }
  if (global_frame_id.empty()) throw ParameterError("global_frame_id", "''", "a frame");
}

SharedMapServerParams loadSharedMapParams(hyselam::ParamLoader& loader) {
  return hyselam::loadDescribed<SharedMapServerParams>(loader);
}

}  // namespace ngram_slam

// The services of TopoEngine.
#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_topo/ros/topo_engine_server.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

namespace hyselam_topo {
namespace {

using hyselam::InputError;

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

}  // namespace

hyselam::Point2 TopoEngineServer::pointOf(const geometry_msgs::PointStamped& point) const {
  const std::string given = withoutSlash(point.header.frame_id);
  if (given.empty()) {
    if (!dialogue_.robot().has_pose) {
      throw InputError("point", "frame_id", "there is none, and the robot has no pose");
    }
    return {dialogue_.robot().pose.x, dialogue_.robot().pose.y};
  }
  if (given != frame()) {
    throw InputError("point", "frame_id",
                     "the map is in frame '" + frame() + "', not in '" + given + "'");
  }
  return {point.point.x, point.point.y};
}

bool TopoEngineServer::onTell(hyselam_msgs::TellRobot::Request& request,
                              hyselam_msgs::TellRobot::Response& response) {
  if (request.text.size() > static_cast<std::size_t>(params_.max_text_bytes)) {
    ++input_.refused;
    response.answers = {"the text has more than max_text_bytes"};
    return true;
  }
  const Reply reply = hear(request.text);
  response.language = reply.language;
  response.answers = reply.sentences;
  return true;
}

bool TopoEngineServer::onUnderstands(hyselam_msgs::TellRobot::Request& request,
                                     hyselam_msgs::TellRobot::Response& response) {
  response.language = dialogue_.reply().language;
  const bool too_long = request.text.size() > static_cast<std::size_t>(params_.max_text_bytes);
  response.answers = too_long ? std::vector<std::string>{"the text has more than max_text_bytes"}
                              : dialogue_.notUnderstood(request.text);
  return true;
}

bool TopoEngineServer::onName(hyselam_msgs::NamePlace::Request& request,
                              hyselam_msgs::NamePlace::Response& response) {
  try {
    updatePose();
    Id place = request.place;
    if (place == 0 && request.point.header.frame_id.empty()) {
      place = dialogue_.robot().place;
    } else if (place == 0) {
      const auto found = placeAt(dialogue_.map(), pointOf(request.point), 0.3);
      place = found ? found->place : 0;
    }
    if (place == 0 || dialogue_.map().findPlace(place) == nullptr) {
      throw InputError("name_place", "", "there is no such place");
    }
    const Reply reply =
        request.names.empty() ? dialogue_.forget(place) : dialogue_.name(place, request.names);
    act(reply);
    response.place = place;
    response.message = reply.text();
    const auto known = namesOf(*dialogue_.map().findPlace(place));
    response.success = request.names.empty() || !known.empty();
  } catch (const std::exception& e) {
    response.message = e.what();
  }
  return true;
}

bool TopoEngineServer::onWhere(hyselam_msgs::WhereAmI::Request&,
                               hyselam_msgs::WhereAmI::Response& response) {
  updatePose();
  publishPlace();
  response.state = last_place_;
  const Place* place = dialogue_.map().findPlace(last_place_.place);
  if (place != nullptr) response.code = codeOf(*place);
  return true;
}

bool TopoEngineServer::onPose(hyselam_msgs::WordToPose::Request& request,
                              hyselam_msgs::WordToPose::Response& response) {
  const auto found = dialogue_.poseOf(request.word);
  if (!found) {
    response.message = "no place of the map is called '" + request.word + "'";
    return true;
  }
  response.found = true;
  response.place = found->first;
  response.pose = poseMsg(found->second);
  return true;
}

bool TopoEngineServer::onInitialPlace(hyselam_msgs::WordToPose::Request& request,
                                      hyselam_msgs::WordToPose::Response& response) {
  onPose(request, response);
  if (response.found) publishers_.initial_pose.publish(response.pose);
  return true;
}

bool TopoEngineServer::onVirtualPlace(hyselam_msgs::AddVirtualPlace::Request& request,
                                      hyselam_msgs::AddVirtualPlace::Response& response) {
  try {
    updatePose();
    const Reply reply =
        dialogue_.addVirtualPlace(pointOf(request.centre), request.radius, request.names);
    act(reply);
    response.place = dialogue_.map().places.back().id;
    response.success = 1;
    response.message = reply.text();
  } catch (const std::exception& e) {
    response.message = e.what();
  }
  return true;
}

bool TopoEngineServer::onLanguage(hyselam_msgs::UseLanguage::Request& request,
                                  hyselam_msgs::UseLanguage::Response& response) {
  response.success = dialogue_.useLanguage(request.language);
  return true;
}

bool TopoEngineServer::onGlassWall(hyselam_msgs::AddGlassWall::Request& request,
                                   hyselam_msgs::AddGlassWall::Response& response) {
  return changeWalls(false, request, response);
}

bool TopoEngineServer::onNoWall(hyselam_msgs::AddGlassWall::Request& request,
                                hyselam_msgs::AddGlassWall::Response& response) {
  return changeWalls(true, request, response);
}

bool TopoEngineServer::changeWalls(bool removes, const hyselam_msgs::AddGlassWall::Request& request,
                                   hyselam_msgs::AddGlassWall::Response& response) {
  try {
    const std::string given = withoutSlash(request.frame_id);
    if (!given.empty() && given != frame()) {
      throw InputError("wall", "frame_id",
                       "the map is in frame '" + frame() + "', not in '" + given + "'");
    }
    DescribedWall wall;
    wall.line = {{request.a.x, request.a.y}, {request.b.x, request.b.y}};
    wall.kind = request.is_virtual ? WallKind::kVirtual : WallKind::kGlass;
    const Reply reply = removes ? dialogue_.removeWall(wall) : dialogue_.addWall(wall);
    act(reply);
    response.success = !reply.actions.empty();
    response.message = reply.text();
  } catch (const std::exception& e) {
    response.message = e.what();
  }
  return true;
}

bool TopoEngineServer::onSave(hyselam_msgs::StatePath::Request& request,
                              hyselam_msgs::StatePath::Response& response) {
  try {
    const std::string& path = request.path.empty() ? params_.state_file : request.path;
    if (path.empty()) throw InputError("save_dialogue", "path", "there is none, nor a state_file");
    save(path);
    input_.put_aside.clear();
    response.success = 1;
    response.message = "the state is written to " + path;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not saved: " << e.what());
  }
  return true;
}

bool TopoEngineServer::onLoad(hyselam_msgs::StatePath::Request& request,
                              hyselam_msgs::StatePath::Response& response) {
  try {
    const std::string& path = request.path.empty() ? params_.state_file : request.path;
    if (path.empty()) throw InputError("load_dialogue", "path", "there is none, nor a state_file");
    load(path);
    input_.put_aside.clear();
    changed_ = true;
    response.success = 1;
    response.message = std::to_string(dialogue_.map().places.size()) + " places read from " + path;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not loaded: " << e.what());
  }
  return true;
}

}  // namespace hyselam_topo

#include "hyselam_objects/ros/object_engine_server.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_objects/link_places.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"

namespace hyselam_objects {

ObjectEngineParams loadObjectEngineParams(hyselam::ParamLoader& loader) {
  using hyselam::Range;
  ObjectEngineParams p;
  loader.get("map_frame", p.map_frame, "frame of the object map");
  loader.get("map_file", p.map_file,
             "object map to begin with, kept up to date; empty: nothing is kept");
  loader.get("autosave_period", p.autosave_period, Range::between(0.1, 3600.0),
             "[s] what was seen is saved so often; what is told, at once");
  loader.get("dictionary_file", p.dictionary_file, "object dictionary, the same");
  loader.get("use_points", p.use_points, "input from the topic points, else from the images");
  loader.get("period", p.period, Range::between(0.0, 60.0),
             "[s] frames that come sooner are left out");
  loader.get("publish_period", p.publish_period, Range::between(0.1, 60.0), "[s]");
  loader.get("tf_patience", p.tf_patience, Range::between(0.0, 5.0), "[s] a pose is waited for");
  loader.get("views_to_learn", p.views_to_learn, Range::between(1, 1000),
             "of a thing that is shown");
  loader.get("range", p.detect.range, Range::between(0.5, 20.0),
             "[m] what is farther is not looked at");
  loader.get("tallest", p.detect.tallest, Range::between(0.1, 3.0), "[m] thing on the floor");
  loader.get("gate", p.mapper.gate, Range::between(0.01, 5.0),
             "[m] a thing and its instance are nearer than this");
  loader.get("confirm", p.mapper.confirm, Range::between(1, 100), "views before a thing is kept");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  return p;
}

ObjectEngineServer::ObjectEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : who_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadObjectEngineParams)),
      map_file_(who_, params_.map_file),
      map_(map_file_.begin(params_.map_frame)),
      parser_(ObjectParser::shipped()),
      fill_(&parser_, &map_),
      mapper_(&map_, {}, params_.mapper),
      shown_(params_.views_to_learn),
      map_publisher_(nh.advertise<hyselam_msgs::ObjectMap>("object_map", 1, true)),
      marker_publisher_(nh.advertise<visualization_msgs::MarkerArray>("object_markers", 1, true)),
      text_publisher_(nh.advertise<std_msgs::String>("robot_text", 20)) {
  talk_publisher_ = nh.advertise<std_msgs::String>("conversation", 100);
  answer_publisher_ = nh.advertise<hyselam_msgs::ObjectAnswer>("object_answer", 20);
  if (!params_.dictionary_file.empty() && std::filesystem::exists(params_.dictionary_file)) {
    dictionary_ = loadDictionary(params_.dictionary_file);
    mapper_.setDictionary(dictionary_);
  }
  mapper_.setPlaces([this](double x, double y) -> std::optional<std::pair<std::string, Point3>> {
    if (!topology_ || !topology_->grid) return std::nullopt;
    const auto& grid = *topology_->grid;
    const hyselam_topo::Place* place =
        topology_->findPlace(grid.placeOf(grid.geometry.cellAt({x, y})));
    if (place == nullptr) return std::nullopt;
    return std::make_pair(nameOf(*place), place->centre.value_or(Point3{x, y, 0.0}));
  });
  publish();  // now: a nodelet's queue is served while its constructor still runs
  save_ = nh.advertiseService("save_object_map", &ObjectEngineServer::onSave, this);
  load_ = nh.advertiseService("load_object_map", &ObjectEngineServer::onLoad, this);
  query_ = nh.advertiseService("query_objects", &ObjectEngineServer::onQuery, this);
  request_ = nh.subscribe("object_request", 20, &ObjectEngineServer::onRequest, this);
  text_ = nh.subscribe("object_text", 20, &ObjectEngineServer::onText, this);
  place_ = nh.subscribe("place", 5, &ObjectEngineServer::onPlace, this);
  topology_subscriber_ = nh.subscribe("topological_map", 1, &ObjectEngineServer::onTopology, this);
  input_.emplace(
      nh,
      FrameInputParams{params_.map_frame, params_.use_points, params_.period, params_.tf_patience},
      [this](const OrganisedCloud& cloud, const PinholeCamera& camera, const ros::Time& stamp) {
        look(cloud, camera, stamp);
      },
      [this](const std::string& reason) { refuse(reason); });
  timer_ = nh.createWallTimer(ros::WallDuration(params_.publish_period),
                              [this](const ros::WallTimerEvent&) { publish(); });
  autosave_timer_ =
      nh.createWallTimer(ros::WallDuration(params_.autosave_period),
                         [this](const ros::WallTimerEvent&) { map_file_.saveAside(map_); });
  diagnostics_.emplace(nh, private_nh.getNamespace().substr(1) + ": objects",
                       params_.diagnostic_period,
                       [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
}

ObjectEngineServer::~ObjectEngineServer() {
  // No callback may change the map while it is written.
  timer_.stop();
  autosave_timer_.stop();
  diagnostics_.reset();
  input_.reset();
  for (ros::Subscriber* subscriber : {&text_, &request_, &place_, &topology_subscriber_}) {
    subscriber->shutdown();
  }
  for (ros::ServiceServer* service : {&save_, &load_, &query_}) service->shutdown();
  map_file_.save(map_);
}

void ObjectEngineServer::look(const OrganisedCloud& cloud, const PinholeCamera& camera,
                              const ros::Time& stamp) {
  const ros::WallTime begin = ros::WallTime::now();
  const std::vector<DetectedObject> seen = detectObjects(cloud, camera.in_map, params_.detect);
  // Before the map takes over what is wrong; but if it stays so, it is the map that was.
  constexpr int kMostHeld = 20;
  landmarks_ = watch_.add(map_, seen);
  const bool off = landmarks_.verdict == LandmarkVerdict::kDisplaced ||
                   landmarks_.verdict == LandmarkVerdict::kDoubtful;
  held_ = off ? held_ + 1 : 0;
  if (held_ > kMostHeld) {
    watch_.clear();
    held_ = 0;
  }
  if (held_ == 0) {
    mapper_.update(cloud, camera, seen, hyselam::toSeconds(stamp));
    fill_.setTime(map_.stamp);
  }
  learn(seen, camera);
  seconds_ = (ros::WallTime::now() - begin).toSec();
  detections_ += seen.size();
  ++frames_;
  error_.clear();
}

void ObjectEngineServer::learn(const std::vector<DetectedObject>& seen,
                               const PinholeCamera& camera) {
  const std::optional<GenericObject> thing = shown_.add(seen, camera);
  if (!thing) return;
  ObjectDictionary learnt;
  learnt.put(*thing);
  dictionary_ = merged(dictionary_, learnt);
  mapper_.setDictionary(dictionary_);
  say(fill_.learnt(thing->name));
  // Last: a file that cannot be written must not make it learn the same again and again.
  if (!params_.dictionary_file.empty()) saveXml(params_.dictionary_file, dictionary_);
}

void ObjectEngineServer::refuse(const std::string& reason) {
  ++refused_;
  error_ = reason;
  ROS_WARN_STREAM_THROTTLE(5.0, who_ << " a frame is not used: " << reason);
}

hyselam_msgs::ObjectAnswer ObjectEngineServer::answer(const std::string& text) {
  hyselam_msgs::ObjectAnswer out;
  const std::vector<std::string> before = fill_.unknownKinds(dictionary_);
  const ObjectMap known = map_;
  std::size_t understood = 0;
  const std::vector<ObjectReply> replies = fill_.say(text);
  for (const ObjectReply& reply : replies) {
    out.reply += (out.reply.empty() ? "" : " ") + reply.text;
    out.objects.insert(out.objects.end(), reply.objects.begin(), reply.objects.end());
    for (const Id id : reply.places) {
      out.places.push_back(map_.findPlace(id)->name);
      out.topological.push_back(map_.findPlace(id)->topological);
    }
    understood += reply.kind != ReplyKind::kNotUnderstood;
    out.asks = reply.kind == ReplyKind::kQuestion;
    if (reply.code == "going") out.go = 1;
    if (reply.code == "shown") shown_.begin(reply.kind_of_object);
  }
  // A part that is not understood is told of in the reply.
  out.understood = understood > 0;
  // NewObject: what is new and cannot be recognised is asked for.
  for (const std::string& kind : fill_.unknownKinds(dictionary_)) {
    if (std::find(before.begin(), before.end(), kind) == before.end()) {
      out.reply += " " + fill_.askToShow(kind);
    }
  }
  all_understood_ = understood == replies.size();
  // Before anybody hears that it is known.
  if (!(map_ == known)) map_file_.save(map_);
  publish();
  return out;
}

void ObjectEngineServer::onRequest(const hyselam_msgs::ObjectRequest::ConstPtr& msg) {
  hyselam_msgs::ObjectAnswer out = answer(msg->text);
  out.id = msg->id;
  answer_publisher_.publish(out);
}

void ObjectEngineServer::onText(const std_msgs::String::ConstPtr& msg) {
  say(answer(msg->data).reply);
}

bool ObjectEngineServer::onQuery(hyselam_msgs::QueryObjects::Request& request,
                                 hyselam_msgs::QueryObjects::Response& response) {
  const hyselam_msgs::ObjectAnswer out = answer(request.text);
  response.understood = all_understood_;
  response.reply = out.reply;
  response.objects = out.objects;
  response.places = out.places;
  return true;
}

void ObjectEngineServer::say(const std::string& text) {
  std_msgs::String msg;
  msg.data = text;
  text_publisher_.publish(msg);
  msg.data = "robot: " + text;
  talk_publisher_.publish(msg);
}

void ObjectEngineServer::onPlace(const hyselam_msgs::PlaceState::ConstPtr& msg) {
  fill_.setPlace(msg->name);
}

void ObjectEngineServer::onTopology(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg) {
  try {
    hyselam_topo::AugmentedTopologicalMap map = hyselam_topo::fromMsg(*msg, "topological_map");
    if (map.frame_id != map_.frame_id) {
      throw hyselam::InputError("topological_map", "frame_id",
                                "is '" + map.frame_id + "', not '" + map_.frame_id + "'");
    }
    topology_ = std::move(map);
    linkPlaces(&map_, *topology_);
  } catch (const std::exception& e) {
    ROS_WARN_STREAM(who_ << " not used: " << e.what());
  }
}

bool ObjectEngineServer::onSave(hyselam_msgs::ObjectMapPath::Request& request,
                                hyselam_msgs::ObjectMapPath::Response& response) {
  const std::string path = request.path.empty() ? params_.map_file : request.path;
  try {
    if (path.empty())
      throw hyselam::InputError("path", "", "is empty, as is the parameter map_file");
    map_file_.wait();  // an older map must not come after this one
    saveXml(path, map_);
    response.success = true;
    response.message = std::to_string(map_.objects.size()) + " objects written to " + path;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not saved: " << e.what());
  }
  return true;
}

bool ObjectEngineServer::onLoad(hyselam_msgs::ObjectMapPath::Request& request,
                                hyselam_msgs::ObjectMapPath::Response& response) {
  const std::string path = request.path.empty() ? params_.map_file : request.path;
  try {
    map_ = loadMapIn(params_.map_frame, path);
    fill_.forgetContext();
    watch_.clear();
    if (topology_) linkPlaces(&map_, *topology_);
    map_file_.save(map_);
    publish();
    response.success = true;
    response.message = std::to_string(map_.objects.size()) + " objects read from " + path;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not loaded: " << e.what());
  }
  return true;
}

void ObjectEngineServer::publish() {
  constexpr double kWeakFor = 20.0;  // what was seen once has so long to be seen again [s]
  mapper_.finish(mapper_.time() - kWeakFor);
  map_publisher_.publish(toMsg(map_));
  marker_publisher_.publish(objectMarkers(map_));
}

void ObjectEngineServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!error_.empty()) hyselam::addRemark(status, DiagnosticStatus::WARN, error_);
  const std::string missing = input_ ? input_->missing() : "";
  if (!missing.empty()) hyselam::addRemark(status, DiagnosticStatus::WARN, missing);
  if (!map_file_.error().empty()) {
    hyselam::addRemark(status, DiagnosticStatus::ERROR, map_file_.error());
  }
  hyselam::addRemark(status, DiagnosticStatus::OK,
                     std::to_string(map_.objects.size()) + " objects in the map");
  if (landmarks_.verdict == LandmarkVerdict::kDisplaced) {
    char text[120];
    std::snprintf(
        text, sizeof(text),
        "the robot seems to be elsewhere: things that do not move are off by %.2f, %.2f m",
        landmarks_.x, landmarks_.y);
    hyselam::addRemark(status, DiagnosticStatus::WARN, text);
  }
  hyselam::addValue(status, "landmarks", toString(landmarks_.verdict));
  hyselam::addValue(status, "landmarks compared", landmarks_.compared);
  hyselam::addValue(status, "landmarks fitting", landmarks_.fitting);
  hyselam::addValue(status, "landmarks chi2", landmarks_.chi2);
  hyselam::addValue(status, "frames held back", held_);
  hyselam::addValue(status, "offset x [m]", landmarks_.x);
  hyselam::addValue(status, "offset y [m]", landmarks_.y);
  hyselam::addValue(status, "frames used", frames_);
  hyselam::addValue(status, "frames refused", refused_);
  hyselam::addValue(status, "frames without a pose", input_->withoutPose());
  hyselam::addValue(status, "detections", detections_);
  hyselam::addValue(status, "last frame [s]", seconds_);
  hyselam::addValue(status, "kinds known", dictionary_.objects.size());
}

}  // namespace hyselam_objects

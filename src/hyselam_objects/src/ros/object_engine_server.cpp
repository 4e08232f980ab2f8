#include "hyselam_objects/ros/object_engine_server.hpp"

#include <cstdio>
#include <filesystem>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_objects/language/answer_text.hpp"
#include "hyselam_objects/language/link_places.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"

namespace hyselam_objects {

void ObjectEngineParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("map_file", map_file,
        "object map, loaded at the start if it exists and kept up to date; empty: none");
  visit("autosave_period", autosave_period, Range::between(0.1, 3600.0), "s",
        "detections are saved so often; what people say is saved at once");
  visit("dictionary_file", dictionary_file,
        "object dictionary, loaded at the start if it exists, saved when an object was learned");
  visit.group("", input);
  visit("publish_period", publish_period, Range::between(0.1, 60.0), "s", "of the object map");
  visit("views_to_learn", views_to_learn, Range::between(1, 1000), "",
        "number of views of an object that a person shows");
  // Names of `detection` and `mapping` are distinct.
  visit.group("", detection);
  visit.group("", mapping);
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s",
        "of the diagnostics");
}

void ObjectEngineParams::validate() const {
  hyselam::checkParameters(*this);
  detection.validate();
  mapping.validate();
}

ObjectEngineParams loadObjectEngineParams(hyselam::ParamLoader& loader) {
  return hyselam::loadDescribed<ObjectEngineParams>(loader);
}

ObjectEngineServer::ObjectEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : log_name_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadObjectEngineParams)),
      map_file_(log_name_, params_.map_file),
      map_(map_file_.load(params_.input.map_frame)),
      parser_(ObjectParser::shipped()),
      fill_map_(parser_, map_),
      mapper_(map_, {}, params_.mapping),
      demonstrated_(params_.views_to_learn) {
  if (!params_.dictionary_file.empty() && std::filesystem::exists(params_.dictionary_file)) {
    dictionary_ = loadDictionary(params_.dictionary_file);
    mapper_.setDictionary(dictionary_);
  }
  mapper_.setPlaceLookup([this](double x, double y) { return placeAt(x, y); });
  advertise(nh);
  subscribe(nh);
  startTimers(nh, private_nh);
}

void ObjectEngineServer::advertise(ros::NodeHandle nh) {
  constexpr std::uint32_t kTexts = 20, kConversation = 100;  // of the queues
  publishers_.map = nh.advertise<hyselam_msgs::ObjectMap>("object_map", 1, true);
  publishers_.markers = nh.advertise<visualization_msgs::MarkerArray>("object_markers", 1, true);
  publishers_.text = nh.advertise<std_msgs::String>("robot_text", kTexts);
  publishers_.conversation = nh.advertise<std_msgs::String>("conversation", kConversation);
  publishers_.answers = nh.advertise<hyselam_msgs::ObjectAnswer>("object_answer", kTexts);
  // Before anything can call back: a nodelet's queue is served while its constructor still runs.
  publishMap();
  services_.save = nh.advertiseService("save_object_map", &ObjectEngineServer::onSave, this);
  services_.load = nh.advertiseService("load_object_map", &ObjectEngineServer::onLoad, this);
  services_.query = nh.advertiseService("query_objects", &ObjectEngineServer::onQuery, this);
}

void ObjectEngineServer::subscribe(ros::NodeHandle nh) {
  constexpr std::uint32_t kTexts = 20, kPlaces = 5;  // of the queues
  using Server = ObjectEngineServer;
  subscribers_.request = nh.subscribe("object_request", kTexts, &Server::onRequest, this);
  subscribers_.text = nh.subscribe("object_text", kTexts, &Server::onText, this);
  subscribers_.place = nh.subscribe("place", kPlaces, &Server::onPlace, this);
  subscribers_.topology = nh.subscribe("topological_map", 1, &Server::onTopology, this);
  input_.emplace(
      nh, params_.input,
      [this](const OrganizedCloud& cloud, const PinholeCamera& camera, const ros::Time& stamp) {
        processFrame(cloud, camera, stamp);
      },
      [this](const std::string& reason) { refuseFrame(reason); });
}

void ObjectEngineServer::startTimers(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) {
  publish_timer_ = nh.createWallTimer(ros::WallDuration(params_.publish_period),
                                      [this](const ros::WallTimerEvent&) { publishMap(); });
  autosave_timer_ =
      nh.createWallTimer(ros::WallDuration(params_.autosave_period),
                         [this](const ros::WallTimerEvent&) { map_file_.saveInBackground(map_); });
  diagnostics_.emplace(nh, private_nh.getNamespace().substr(1) + ": objects",
                       params_.diagnostic_period,
                       [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
}

ObjectEngineServer::~ObjectEngineServer() {
  // No callback may change the map while it is written.
  publish_timer_.stop();
  autosave_timer_.stop();
  diagnostics_.reset();
  input_.reset();
  for (ros::Subscriber* each :
       {&subscribers_.text, &subscribers_.request, &subscribers_.place, &subscribers_.topology}) {
    each->shutdown();
  }
  for (ros::ServiceServer* each : {&services_.save, &services_.load, &services_.query}) {
    each->shutdown();
  }
  map_file_.save(map_);
}

/// Name and center of the place at a position.
std::optional<std::pair<std::string, Point3>> ObjectEngineServer::placeAt(double x,
                                                                          double y) const {
  if (!topology_ || !topology_->grid) return std::nullopt;
  const auto& grid = *topology_->grid;
  const hyselam_topo::Place* place =
      topology_->findPlace(grid.placeOf(grid.geometry.cellAt({x, y})));
  if (place == nullptr) return std::nullopt;
  return std::make_pair(nameOf(*place), place->centre.value_or(Point3{x, y, 0.0}));
}

void ObjectEngineServer::processFrame(const OrganizedCloud& cloud, const PinholeCamera& camera,
                                      const ros::Time& stamp) {
  const ros::WallTime begin = ros::WallTime::now();
  const std::vector<DetectedObject> detections =
      detectObjects(cloud, camera.in_map, params_.detection);
  if (guard_.allowsUpdate(map_, detections)) {
    mapper_.update(cloud, camera, detections, hyselam::toSeconds(stamp));
    fill_map_.setTime(map_.stamp);
  }
  learnDemonstrated(detections, camera);
  frames_.seconds = (ros::WallTime::now() - begin).toSec();
  frames_.detections += detections.size();
  ++frames_.used;
  frames_.error.clear();
}

void ObjectEngineServer::learnDemonstrated(const std::vector<DetectedObject>& detections,
                                           const PinholeCamera& camera) {
  const std::optional<GenericObject> object = demonstrated_.addView(detections, camera);
  if (!object) return;
  ObjectDictionary learned;
  learned.put(*object);
  dictionary_ = merged(dictionary_, learned);
  mapper_.setDictionary(dictionary_);
  publishText(fill_map_.learnedReply(object->name));
  // Last: if the file cannot be written, the object is known nevertheless.
  if (!params_.dictionary_file.empty()) saveXml(params_.dictionary_file, dictionary_);
}

void ObjectEngineServer::refuseFrame(const std::string& reason) {
  ++frames_.refused;
  frames_.error = reason;
  ROS_WARN_STREAM_THROTTLE(5.0, log_name_ << " a frame is not used: " << reason);
}

hyselam_msgs::ObjectAnswer ObjectEngineServer::answer(const std::string& text) {
  const ObjectMap map_before = map_;
  const TextAnswer answer = answerText(text, parser_, map_, dictionary_, fill_map_);
  hyselam_msgs::ObjectAnswer out;
  out.reply = answer.text;
  out.understood = answer.understood;
  out.about_things = answer.about_things;
  out.reason = answer.reason;
  out.is_question = answer.is_question;
  out.go_to_place = answer.go_to_place;
  out.objects = answer.objects;
  for (const ObjectPlace& place : answer.places) {
    out.places.push_back(place.name);
    out.place_ids.push_back(place.topological);
  }
  for (const std::string& kind : answer.shown) demonstrated_.start(kind);
  all_understood_ = answer.all_understood;
  // Saved before anybody gets the confirmation.
  if (!(map_ == map_before)) map_file_.save(map_);
  publishMap();
  return out;
}

void ObjectEngineServer::onRequest(const hyselam_msgs::ObjectRequest::ConstPtr& msg) {
  if (msg->end_question != 0) {
    fill_map_.dropQuestion();
    return;
  }
  hyselam_msgs::ObjectAnswer out = answer(msg->text);
  out.id = msg->id;
  publishers_.answers.publish(out);
}

void ObjectEngineServer::onText(const std_msgs::String::ConstPtr& msg) {
  publishText(answer(msg->data).reply);
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

void ObjectEngineServer::publishText(const std::string& text) {
  publishers_.text.publish(hyselam::toStringMsg(text));
  publishers_.conversation.publish(hyselam::toStringMsg("robot: " + text));
}

void ObjectEngineServer::onPlace(const hyselam_msgs::PlaceState::ConstPtr& msg) {
  fill_map_.setRobotPlace(msg->name);
}

void ObjectEngineServer::onTopology(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg) {
  try {
    hyselam_topo::AugmentedTopologicalMap map = hyselam_topo::fromMsg(*msg, "topological_map");
    if (map.frame_id != map_.frame_id) {
      throw hyselam::InputError("topological_map", "frame_id",
                                "is '" + map.frame_id + "', not '" + map_.frame_id + "'");
    }
    topology_ = std::move(map);
    linkPlaces(map_, *topology_, place_names_);
  } catch (const std::exception& e) {
    ROS_WARN_STREAM(log_name_ << " not used: " << e.what());
  }
}

bool ObjectEngineServer::onSave(hyselam_msgs::ObjectMapPath::Request& request,
                                hyselam_msgs::ObjectMapPath::Response& response) {
  const std::string path = request.path.empty() ? params_.map_file : request.path;
  try {
    if (path.empty()) {
      throw hyselam::InputError("path", "", "is empty, as is the parameter map_file");
    }
    map_file_.wait();  // an older map must not be written after this one
    saveXml(path, map_);
    response.success = true;
    response.message = std::to_string(map_.objects.size()) + " objects written to " + path;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved: " << e.what());
  }
  return true;
}

bool ObjectEngineServer::onLoad(hyselam_msgs::ObjectMapPath::Request& request,
                                hyselam_msgs::ObjectMapPath::Response& response) {
  const std::string path = request.path.empty() ? params_.map_file : request.path;
  try {
    map_ = loadMapInFrame(params_.input.map_frame, path);
    fill_map_.resetContext();
    guard_.clear();
    if (topology_) linkPlaces(map_, *topology_, place_names_);
    map_file_.save(map_);
    publishMap();
    response.success = true;
    response.message = std::to_string(map_.objects.size()) + " objects read from " + path;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not loaded: " << e.what());
  }
  return true;
}

void ObjectEngineServer::publishMap() {
  constexpr double kUnconfirmedFor = 20.0;  // an object seen once is kept so long [s]
  mapper_.consolidate(mapper_.time() - kUnconfirmedFor);
  publishers_.map.publish(toMsg(map_));
  publishers_.markers.publish(objectMarkers(map_));
}

void ObjectEngineServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const LandmarkCheck& landmarks = guard_.lastCheck();
  if (!frames_.error.empty()) hyselam::addRemark(status, DiagnosticStatus::WARN, frames_.error);
  const std::string missing = input_ ? input_->missing() : "";
  if (!missing.empty()) hyselam::addRemark(status, DiagnosticStatus::WARN, missing);
  if (!map_file_.error().empty()) {
    hyselam::addRemark(status, DiagnosticStatus::ERROR, map_file_.error());
  }
  hyselam::addRemark(status, DiagnosticStatus::OK,
                     std::to_string(map_.objects.size()) + " objects in the map");
  if (landmarks.verdict == LandmarkVerdict::kDisplaced) {
    char text[120];
    std::snprintf(
        text, sizeof(text),
        "the robot seems to be elsewhere: objects that do not move are off by %.2f, %.2f m",
        landmarks.x, landmarks.y);
    hyselam::addRemark(status, DiagnosticStatus::WARN, text);
  }
  hyselam::addValue(status, "landmarks", toString(landmarks.verdict));
  hyselam::addValue(status, "landmarks compared", landmarks.compared);
  hyselam::addValue(status, "landmarks fitting", landmarks.inliers);
  hyselam::addValue(status, "landmarks chi2", landmarks.chi2);
  hyselam::addValue(status, "frames held back", guard_.framesHeldBack());
  hyselam::addValue(status, "offset x [m]", landmarks.x);
  hyselam::addValue(status, "offset y [m]", landmarks.y);
  hyselam::addValue(status, "frames used", frames_.used);
  hyselam::addValue(status, "frames refused", frames_.refused);
  hyselam::addValue(status, "frames without a pose", input_->framesWithoutPose());
  hyselam::addValue(status, "detections", frames_.detections);
  hyselam::addValue(status, "last frame [s]", frames_.seconds);
  hyselam::addValue(status, "kinds known", dictionary_.objects.size());
}

}  // namespace hyselam_objects

#include "hyselam_objects/ros/object_engine_server.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_objects/link_places.hpp"
#include "hyselam_objects/object_descriptor.hpp"
#include "hyselam_topo/ros/conversions.hpp"

namespace hyselam_objects {
namespace {

constexpr double kTimeBack = 0.5;     // [s] a smaller step back is a late frame
constexpr double kRetryEvery = 0.01;  // [s] while a frame waits for its pose

/// An object map that messages can hold, in that frame. Throws hyselam::InputError.
ObjectMap loadMapIn(const std::string& frame_id, const std::string& path) {
  ObjectMap map = loadObjectMap(path);
  if (map.frame_id != frame_id) {
    throw hyselam::InputError(path, "frame_id",
                              "is '" + map.frame_id + "', not '" + frame_id + "'");
  }
  hyselam::toRosTime(map.stamp, path);  // what no message can hold is refused
  toMsg(map);                           // the times of its objects, too
  return map;
}

}  // namespace

ObjectEngineParams loadObjectEngineParams(hyselam::ParamLoader& loader) {
  using hyselam::Range;
  ObjectEngineParams p;
  loader.get("map_frame", p.map_frame, "frame of the object map");
  loader.get("map_file", p.map_file, "object map to begin with, and to save to; empty: none");
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
      params_(hyselam::loadAndTell(private_nh, loadObjectEngineParams)),
      parser_(ObjectParser::shipped()),
      fill_(&parser_, &map_),
      mapper_(&map_, {}, params_.mapper),
      tf_listener_(tf_buffer_),
      map_publisher_(nh.advertise<hyselam_msgs::ObjectMap>("object_map", 1, true)),
      marker_publisher_(nh.advertise<visualization_msgs::MarkerArray>("object_markers", 1, true)),
      text_publisher_(nh.advertise<std_msgs::String>("robot_text", 20)) {
  talk_publisher_ = nh.advertise<std_msgs::String>("conversation", 100);
  answer_publisher_ = nh.advertise<hyselam_msgs::ObjectAnswer>("object_answer", 20);
  map_.frame_id = params_.map_frame;
  if (!params_.map_file.empty() && std::filesystem::exists(params_.map_file)) {
    map_ = loadMapIn(params_.map_frame, params_.map_file);
  }
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
  if (params_.use_points) {
    points_ = nh.subscribe("points", 1, &ObjectEngineServer::onPoints, this);
  } else {
    info_ = nh.subscribe("camera/depth/camera_info", 1, &ObjectEngineServer::onInfo, this);
    depth_ = std::make_unique<message_filters::Subscriber<Image>>(nh, "camera/depth/image_raw", 5);
    colour_ = std::make_unique<message_filters::Subscriber<Image>>(nh, "camera/color/image_raw", 5);
    images_ =
        std::make_unique<message_filters::TimeSynchronizer<Image, Image>>(*depth_, *colour_, 10);
    images_->registerCallback(&ObjectEngineServer::onImages, this);
  }
  pose_timer_ = nh.createWallTimer(
      ros::WallDuration(kRetryEvery), [this](const ros::WallTimerEvent&) { serveWaiting(); }, false,
      false);
  timer_ = nh.createWallTimer(ros::WallDuration(params_.publish_period),
                              [this](const ros::WallTimerEvent&) { publish(); });
  diagnostics_.emplace(nh, private_nh.getNamespace().substr(1) + ": objects",
                       params_.diagnostic_period,
                       [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
}

void ObjectEngineServer::onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg) {
  try {
    camera_ = cameraOf(*msg);
  } catch (const hyselam::InputError& e) {
    refuse(e.what());
  }
}

bool ObjectEngineServer::isDue(const std_msgs::Header& header) {
  const bool back = header.stamp < last_frame_;  // a bag begins again
  if ((last_frame_ - header.stamp).toSec() > kTimeBack) {
    // A transform of before, received after the listener forgot them, would make it refuse all new
    // ones.
    tf_buffer_.clear();
    waiting_.reset();
  }
  if (!back && !last_frame_.isZero() && (header.stamp - last_frame_).toSec() < params_.period) {
    return false;
  }
  last_frame_ = header.stamp;
  return true;
}

void ObjectEngineServer::onImages(const Image::ConstPtr& depth, const Image::ConstPtr& colour) {
  if (!camera_ || !isDue(depth->header)) return;
  await(depth->header, [this, depth, colour, camera = *camera_](const Eigen::Isometry3d& in_map) {
    look(cloudOf(*depth, colour.get(), camera), camera, in_map, depth->header.stamp);
  });
}

void ObjectEngineServer::onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg) {
  if (!isDue(msg->header)) return;
  await(msg->header, [this, msg](const Eigen::Isometry3d& in_map) {
    const OrganisedCloud cloud = cloudOf(*msg);
    // The focal length follows from the points themselves: u - cx = f x / z.
    PinholeCamera camera;
    camera.cx = 0.5 * cloud.width - 0.5;
    camera.cy = 0.5 * cloud.height - 0.5;
    std::vector<double> across, down;
    for (std::size_t i = 0; i < cloud.size(); i += 17) {
      const Point& p = cloud.points[i];
      if (!cloud.isValid(i)) continue;
      const double u = static_cast<double>(i % static_cast<std::size_t>(cloud.width)) - camera.cx;
      const double v = static_cast<double>(i / static_cast<std::size_t>(cloud.width)) - camera.cy;
      if (std::abs(p.x()) > 0.05f) across.push_back(u * p.z() / p.x());
      if (std::abs(p.y()) > 0.05f) down.push_back(v * p.z() / p.y());
    }
    if (across.size() < 20 || down.size() < 20) {
      throw hyselam::InputError("points", "", "hardly a point is valid");
    }
    const auto median = [](std::vector<double>* all) {
      const auto middle = all->begin() + static_cast<std::ptrdiff_t>(all->size() / 2);
      std::nth_element(all->begin(), middle, all->end());
      return *middle;
    };
    camera.focal_length = median(&across);
    const double other = median(&down);
    if (!(camera.focal_length > 0.0 && other > 0.0 && std::isfinite(camera.focal_length))) {
      throw hyselam::InputError("points", "",
                                "they are not in the order of a camera's picture: x does not grow "
                                "to the right, or y not downwards");
    }
    look(cloud, camera, in_map, msg->header.stamp);
  });
}

// Waiting must not block: it would hold up the other nodelets of the manager, and for ever while
// the clock stands.
void ObjectEngineServer::await(const std_msgs::Header& header, UseFrame use) {
  if (waiting_) refuseWithoutPose("a newer frame has come");
  waiting_ = {header, std::move(use), ros::WallTime::now()};
  serveWaiting();
}

void ObjectEngineServer::serveWaiting() {
  if (!waiting_) return;
  const std_msgs::Header& header = waiting_->header;
  std::string why;
  if (tf_buffer_.canTransform(map_.frame_id, header.frame_id, header.stamp, &why)) {
    const Waiting frame = std::move(*waiting_);
    waiting_.reset();
    pose_timer_.stop();
    try {
      const geometry_msgs::Transform pose =
          tf_buffer_.lookupTransform(map_.frame_id, frame.header.frame_id, frame.header.stamp)
              .transform;
      const auto& t = pose.translation;
      const auto& q = pose.rotation;
      frame.use(Eigen::Translation3d(t.x, t.y, t.z) *
                Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
    } catch (const std::exception& e) {
      refuse(e.what());
    }
  } else if ((ros::WallTime::now() - waiting_->since).toSec() >= params_.tf_patience) {
    refuseWithoutPose(why);
  } else {
    pose_timer_.start();
  }
}

void ObjectEngineServer::refuseWithoutPose(const std::string& why) {
  waiting_.reset();
  pose_timer_.stop();
  ++without_pose_;
  refuse("the camera's pose is not known: " + why);
}

void ObjectEngineServer::look(const OrganisedCloud& cloud, PinholeCamera camera,
                              const Eigen::Isometry3d& camera_in_map, const ros::Time& stamp) {
  camera.in_map = camera_in_map;
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
  if (shown_.empty()) return;
  // What is shown stands nearest to the middle of the picture.
  const Eigen::Isometry3d map_in_camera = camera.in_map.inverse();
  const DetectedObject* best = nullptr;
  double least = 0.35;  // tangent of the angle from the axis
  for (const DetectedObject& each : seen) {
    if (each.furniture || each.cut) continue;
    const Point3 c = each.centre();
    const Eigen::Vector3d p = map_in_camera * Eigen::Vector3d(c.x, c.y, c.z);
    const double off = p.z() > 0.0 ? std::hypot(p.x(), p.y()) / p.z() : 1e9;
    if (off < least) {
      least = off;
      best = &each;
    }
  }
  if (best == nullptr) return;
  shown_views_.push_back(best->descriptor);
  shown_sizes_.emplace_back(best->high.x - best->low.x, best->high.y - best->low.y,
                            best->high.z - best->low.z);
  if (shown_views_.size() < static_cast<std::size_t>(params_.views_to_learn)) return;
  ObjectDictionary learnt;
  learnt.put(learnObject(shown_, shown_views_, shown_sizes_));
  dictionary_ = merged(dictionary_, learnt);
  mapper_.setDictionary(dictionary_);
  say(fill_.learnt(shown_));
  shown_.clear();
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
    if (reply.code == "shown") {
      shown_ = reply.kind_of_object;
      shown_views_.clear();
      shown_sizes_.clear();
    }
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
  hyselam::addValue(status, "frames without a pose", without_pose_);
  hyselam::addValue(status, "detections", detections_);
  hyselam::addValue(status, "last frame [s]", seconds_);
  hyselam::addValue(status, "kinds known", dictionary_.objects.size());
}

}  // namespace hyselam_objects

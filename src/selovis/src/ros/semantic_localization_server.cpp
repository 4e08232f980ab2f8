#include "selovis/ros/semantic_localization_server.hpp"

#include <hyselam_msgs/VisualPlace.h>

#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_common/ros/transport.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"
#include "selovis/ros/place_markers.hpp"
#include "selovis/ros/sensor_images.hpp"

namespace selovis {
namespace {

constexpr double kPollEvery = 0.005;  // [s] of wall time: images that wait, training that ends
constexpr double kPoseAge = 0.5;      // [s] a pose so old is still that of the image
constexpr double kDepthPause = 1.0;   // [s] without depth images: none come any more
constexpr int kRangeColumns = 40;     // distances taken from a laser scan

std::shared_ptr<const Model> firstModel(const SemanticLocalizationParams& params,
                                        const std::string& who) {
  if (holdsModel(params.save_model)) {
    if (!params.model.empty() && params.model != params.save_model) {
      ROS_WARN_STREAM(who << " goes on with " << params.save_model << ", not with "
                          << params.model);
    }
    return std::make_shared<Model>(loadModel(params.save_model));
  }
  if (!params.model.empty()) return std::make_shared<Model>(loadModel(params.model));
  TrainingOptions options;
  options.descriptor = params.descriptor;
  options.classifier.kernel = kernelOf(params.kernel);
  if (options.classifier.kernel == Kernel::kExemplar) options.views = exemplarViews();
  try {
    return std::make_shared<Model>(emptyModel(options));
  } catch (const hyselam::ParameterError&) {
    throw;
  } catch (const std::invalid_argument& e) {
    throw hyselam::InputError("parameter 'descriptor'", "", e.what());
  }
}

}  // namespace

SemanticLocalizationServer::SemanticLocalizationServer(ros::NodeHandle nh,
                                                       ros::NodeHandle private_nh)
    : who_(hyselam::logName(private_nh)),
      image_topic_(nh.resolveName("image")),
      params_(hyselam::loadAndLogParams(private_nh, loadParams)),
      learning_(params_.learn),
      tf_listener_(tf_, true, hyselam::tcpNoDelay()),
      supervision_(nh, private_nh, params_, who_),
      place_publisher_(nh.advertise<hyselam_msgs::VisualPlace>("visual_place", 100)),
      marker_publisher_(nh.advertise<visualization_msgs::MarkerArray>("place_markers", 1, true)),
      transport_(nh) {
  const auto first = firstModel(params_, who_);
  needs_ = needsOf(first->descriptor);
  learner_ = std::make_unique<Learner>(first, params_.learner);
  if (params_.recogniser.filter.kind == FilterKind::kPoses &&
      first->classifier.kernel != Kernel::kExemplar) {
    throw hyselam::InputError("parameter 'filter'", "",
                              "'poses' needs a model with the exemplar kernel");
  }
  try {
    useModel(first);
  } catch (const hyselam::ParameterError&) {
    throw;
  } catch (const std::invalid_argument& e) {
    throw hyselam::InputError("parameter 'model'", params_.model, e.what());
  }

  // Before all that starts it: a nodelet's queue is served while its constructor still runs.
  timer_ = nh.createWallTimer(
      ros::WallDuration(kPollEvery),
      [this](const ros::WallTimerEvent&) {
        takeTrained();
        serveWaiting();
        restIfIdle();
      },
      false, false);
  const auto queue = static_cast<std::uint32_t>(params_.queue_size);
  if (params_.image_transport == "compressed") {
    // Without the plugin, and with a look at whether the picture is whole.
    subscribers_.push_back(nh.subscribe<sensor_msgs::CompressedImage>(
        "image/compressed", queue,
        [this](const sensor_msgs::CompressedImage::ConstPtr& msg) {
          onImage({nullptr, msg, msg->header, ros::WallTime::now()});
        },
        ros::VoidConstPtr(), hyselam::tcpNoDelay()));
  } else {
    image_subscriber_ = transport_.subscribe(
        "image", queue,
        [this](const sensor_msgs::ImageConstPtr& msg) {
          onImage({msg, nullptr, msg->header, ros::WallTime::now()});
        },
        ros::VoidPtr(),
        image_transport::TransportHints(params_.image_transport, hyselam::tcpNoDelay()));
  }
  subscribers_.push_back(nh.subscribe<sensor_msgs::CameraInfo>(
      "camera_info", 5,
      [this](const sensor_msgs::CameraInfo::ConstPtr& info) {
        if (info->K[0] > 0.0 && info->K[4] > 0.0 && info->width > 0 && info->height > 0) {
          aperture_ = 2.0 * std::atan(0.5 * info->width / info->K[0]);
          aperture_y_ = 2.0 * std::atan(0.5 * info->height / info->K[4]);
        }
      },
      ros::VoidConstPtr(), hyselam::tcpNoDelay()));
  // What is read beside the picture.
  const auto read = [&](auto& history, const char* topic, std::uint32_t size) {
    using Message = typename std::decay_t<decltype(history)>::Message;
    subscribers_.push_back(nh.subscribe<Message>(
        topic, size,
        [this, &history](const typename Message::ConstPtr& msg) { onReading(history, msg); },
        ros::VoidConstPtr(), hyselam::tcpNoDelay()));
  };
  if (needs_.scan || needs_.ranges) read(scans_, "scan", 100);
  if (needs_.ranges) read(depths_, "depth", queue);
  if (needs_.heading) read(imus_, "imu", 200);
  if (needs_.magnetic) read(fields_, "magnetic_field", 200);
  subscribers_.push_back(
      nh.subscribe("topological_map", 2, &SemanticLocalizationServer::onMap, this));
  subscribers_.push_back(nh.subscribe<hyselam_msgs::PlaceState>(
      "place", 20, [this](const hyselam_msgs::PlaceState::ConstPtr& msg) { place_ = msg; }));
  using Self = SemanticLocalizationServer;
  services_ = {private_nh.advertiseService("start_learning", &Self::onStartLearning, this),
               private_nh.advertiseService("stop_learning", &Self::onStopLearning, this),
               private_nh.advertiseService("retrain", &Self::onRetrain, this),
               private_nh.advertiseService("save", &Self::onSave, this)};
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": visual places", params_.diagnostic_period,
      [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
}

SemanticLocalizationServer::~SemanticLocalizationServer() {
  timer_.stop();
  image_subscriber_.shutdown();
  for (auto& subscriber : subscribers_) subscriber.shutdown();
  for (auto& service : services_) service.shutdown();
}

void SemanticLocalizationServer::restIfIdle() {
  if (!waiting_.empty() || training_.busy()) return;
  const std::lock_guard<std::mutex> lock(trained_mutex_);
  if (!trained_) timer_.stop();
}

// What comes in.

void SemanticLocalizationServer::onImage(Waiting image) {
  ++received_;
  if ((last_image_ - image.header.stamp).toSec() > kClockSlack) {
    ROS_WARN_STREAM(who_ << " time went back: starting afresh");
    waiting_.clear();
    tf_.clear();
    if (recogniser_) recogniser_->reset();
    if (!graph_.places.empty()) supervision_.setGraph(graph_);
  }
  last_image_ = image.header.stamp;
  waiting_.push_back(std::move(image));
  while (waiting_.size() > static_cast<std::size_t>(params_.queue_size)) {
    drop("queue full", "the oldest of the images that waited");
    waiting_.pop_front();
  }
  serveWaiting();
  if (!waiting_.empty()) timer_.start();
}

template <typename M>
void SemanticLocalizationServer::onReading(SensorHistory<M>& history,
                                           const typename M::ConstPtr& reading) {
  history.add(reading);
  serveWaiting();
}

void SemanticLocalizationServer::serveWaiting() {
  while (!waiting_.empty()) {
    const Waiting image = waiting_.front();
    try {
      const auto readings = readingsFor(image);
      if (!readings) return;
      waiting_.pop_front();
      serve(image, *readings);
    } catch (const std::exception& e) {
      if (!waiting_.empty() && waiting_.front().header.stamp == image.header.stamp &&
          waiting_.front().since == image.since) {
        waiting_.pop_front();
        drop("no reading", e.what());
      } else {
        drop("refused", e.what());
      }
    }
  }
}

std::optional<Readings> SemanticLocalizationServer::readingsFor(const Waiting& image) const {
  const ros::Time& stamp = image.header.stamp;
  Readings readings;
  readings.stamp = stamp.toSec();
  const bool waited = (ros::WallTime::now() - image.since).toSec() >= params_.sync_wait;
  // Ranges by depth go before those by a scan: as long as depth comes, it is waited for.
  if (needs_.ranges && !waited && depths_.nearest(stamp, kDepthPause) && !depths_.reaches(stamp)) {
    return {};
  }
  const bool by_depth = needs_.ranges && depths_.nearest(stamp, params_.sync_tolerance);
  const auto find = [&](const auto& history, const char* what) {
    auto msg = history.nearest(stamp, params_.sync_tolerance);
    if (!msg && waited) {
      throw hyselam::InputError(image_topic_, "",
                                std::string("no ") + what + " came within " +
                                    std::to_string(params_.sync_tolerance) + " s of an image");
    }
    return msg;
  };
  // A later message may lie nearer, until one of the image's time or after it has come.
  const auto ready = [&](const auto& history) { return waited || history.reaches(stamp); };
  if (needs_.scan || (needs_.ranges && !by_depth)) {
    if (!ready(scans_)) return {};
    const auto scan = find(scans_, needs_.scan ? "scan" : "scan or depth image");
    if (!scan) return {};
    if (needs_.scan) readings.scan = scan->ranges;
    if (needs_.ranges) {
      double yaw = 0.0;
      try {
        // The camera's optical axis in the laser's plane.
        const auto axis =
            tf_.lookupTransform(scan->header.frame_id, image.header.frame_id, ros::Time(0));
        tf2::Quaternion q(axis.transform.rotation.x, axis.transform.rotation.y,
                          axis.transform.rotation.z, axis.transform.rotation.w);
        const tf2::Vector3 forward = tf2::quatRotate(q.normalized(), tf2::Vector3(0.0, 0.0, 1.0));
        yaw = -std::atan2(forward.y(), forward.x());
      } catch (const tf2::TransformException&) {
        // Mounted alike, as far as is known.
      }
      readings.ranges =
          rangesAcross(*scan, aperture_.value_or(params_.learner.aperture_x), yaw, kRangeColumns);
    }
  }
  if (by_depth) {
    readings.ranges = rangesOfDepth(
        depthFromMsg(depths_.nearest(stamp, params_.sync_tolerance), "depth"), kDepthColumns);
  }
  if (needs_.heading) {
    if (!ready(imus_)) return {};
    const auto imu = find(imus_, "imu");
    if (!imu) return {};
    readings.heading = hyselam::yawFromMsg(imu->orientation, "imu");
  }
  if (needs_.magnetic) {
    if (!ready(fields_)) return {};
    const auto field = find(fields_, "magnetic_field");
    if (!field) return {};
    readings.magnetic = {field->magnetic_field.x, field->magnetic_field.y, field->magnetic_field.z};
  }
  if (recogniser_ && params_.recogniser.filter.kind == FilterKind::kPoses &&
      !params_.odom_frame_id.empty()) {
    // tf comes by a way of its own: what is known already may be of a moment before the image.
    const auto at = [&](const ros::Time& time) {
      return tf_.canTransform(params_.odom_frame_id, params_.base_frame_id, time);
    };
    if (!waited && at(ros::Time(0)) && !at(stamp)) return {};
    readings.odometry = poseIn(params_.odom_frame_id, image.header.frame_id, stamp);
    if (!readings.odometry) {
      readings.odometry = poseIn(params_.odom_frame_id, params_.base_frame_id, stamp);
    }
  }
  return readings;
}

void SemanticLocalizationServer::serve(const Waiting& image, const Readings& readings) {
  const cv::Mat picture = image.raw ? fromMsg(image.raw, image_topic_)
                                    : fromMsg(*image.compressed, image_topic_ + "/compressed");
  const ros::WallTime begin = ros::WallTime::now();
  if (recogniser_) {
    const Recognition recognition = recogniser_->update(picture, readings);
    frame_ms_ = 1e3 * (ros::WallTime::now() - begin).toSec();
    if (map_ && recognition.descriptive && !recognition.novel) {
      supervision_.judge(recogniser_->frameProbabilities(),
                         poseInMap(params_.base_frame_id, image.header.stamp), *map_,
                         image.header.stamp);
    }
    publish(recognition, image.header);
  }
  if (learning_) keep(picture, readings, image.header);
  ++used_;
}

void SemanticLocalizationServer::publish(const Recognition& r, const std_msgs::Header& header) {
  const auto& places = recogniser_->places();
  const auto nameAt = [&](int i) {
    return i < 0 ? std::string() : places[static_cast<std::size_t>(i)];
  };
  const auto idOf = [&](const std::string& name) -> std::uint32_t {
    if (!map_ || name.empty()) return 0;
    for (const auto& place : map_->places) {
      if (hyselam_topo::nameOf(place) == name) return place.id;
    }
    return 0;
  };
  hyselam_msgs::VisualPlace msg;
  msg.header = header;
  msg.name = nameAt(r.estimate.place);
  msg.place = idOf(msg.name);
  msg.probability = r.estimate.probability;
  msg.transition = r.estimate.second >= 0;
  msg.second_name = nameAt(r.estimate.second);
  msg.second_place = idOf(msg.second_name);
  msg.frame_name = nameAt(r.frame_place);
  msg.descriptive = r.descriptive;
  msg.novelty = r.novelty;
  msg.names = places;
  msg.probabilities = recogniser_->probabilities();
  place_publisher_.publish(msg);
  last_place_ = msg.name;
  if (map_ && marker_publisher_.getNumSubscribers() > 0) {
    marker_publisher_.publish(placeMarkers(*map_, places, recogniser_->probabilities(),
                                           r.estimate.place, supervision_.kidnapped(),
                                           params_.marker_height));
  }
}

void SemanticLocalizationServer::drop(const std::string& reason, const std::string& detail) {
  ++dropped_;
  last_drop_ = reason + ": " + detail;
  const std::size_t count = ++drops_[reason];
  if (count == 1) {
    ROS_WARN_STREAM(who_ << " image dropped: " << last_drop_);
  } else {
    ROS_WARN_STREAM_THROTTLE(10.0, who_ << " images dropped (" << dropped_ << "): " << last_drop_);
  }
}

std::optional<hyselam::Pose2> SemanticLocalizationServer::poseInMap(const std::string& child,
                                                                    const ros::Time& stamp,
                                                                    double* height) const {
  return poseIn(params_.global_frame_id, child, stamp, height);
}

std::optional<hyselam::Pose2> SemanticLocalizationServer::poseIn(const std::string& map,
                                                                 const std::string& child,
                                                                 const ros::Time& stamp,
                                                                 double* height) const {
  if (map.empty() || child.empty()) return {};
  try {
    geometry_msgs::TransformStamped found;
    if (tf_.canTransform(map, child, stamp)) {
      found = tf_.lookupTransform(map, child, stamp);
    } else {
      found = tf_.lookupTransform(map, child, ros::Time(0));
      if (!found.header.stamp.isZero() &&
          std::abs((found.header.stamp - stamp).toSec()) > kPoseAge) {
        return {};
      }
    }
    if (height != nullptr) *height = found.transform.translation.z;
    // Heading: of the x axis of the base, of the optical axis of a camera.
    if (child == params_.base_frame_id) return hyselam::fromMsg(found.transform, "tf");
    const auto& r = found.transform.rotation;
    const tf2::Vector3 forward =
        tf2::quatRotate(tf2::Quaternion(r.x, r.y, r.z, r.w).normalized(), tf2::Vector3(0, 0, 1));
    return hyselam::Pose2{found.transform.translation.x, found.transform.translation.y,
                          std::atan2(forward.y(), forward.x())};
  } catch (const tf2::TransformException&) {
    return {};
  } catch (const hyselam::InputError&) {
    return {};
  }
}

// The map and the model.

void SemanticLocalizationServer::onMap(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg) {
  std::vector<Renaming> renamings;
  try {
    auto map = hyselam_topo::fromMsg(*msg, "topological_map");
    if (map_) renamings = renamedPlaces(*map_, map);
    map_ = std::move(map);
    map_error_.clear();
  } catch (const std::exception& e) {
    map_error_ = e.what();  // the one before stays
    ROS_ERROR_STREAM(who_ << " not used: " << e.what());
    return;
  }
  const PlaceGraph before = graph_;
  if (!renamings.empty()) rename(renamings);
  rebuild();
  if (!(before.places == graph_.places && before.transitions == graph_.transitions) &&
      !not_on_map_.empty()) {
    ROS_WARN_STREAM(who_ << " " << not_on_map_.size() << " of the places that were learnt are not "
                         << "on the map, '" << not_on_map_.front() << "' among them");
  }
  if (model_->samples.count() == 0 && !tried_map_) {
    std::vector<LearntFrame> frames = framesOf(*map_, *model_);
    const std::size_t count = frames.size();
    if (count > 0 && train(std::move(frames))) {
      timer_.start();
      tried_map_ = true;
      training_frames_ = trained_frames_;
      ROS_INFO_STREAM(who_ << " learning from " << count << " signatures of the map");
    }
  }
}

void SemanticLocalizationServer::useModel(std::shared_ptr<const Model> model) {
  model_ = std::move(model);
  recogniser_.reset();
  rebuild();
}

void SemanticLocalizationServer::rebuild() {
  if (model_->samples.count() == 0) return;
  PlaceGraph graph = model_->graph;
  not_on_map_.clear();
  if (map_) {
    const PlaceGraph mapped = graphOf(*map_);
    const PlaceGraph of_map = reordered(mapped, model_->graph.places, &not_on_map_);
    // A map that does not know one of the places has nothing to say about them.
    if (not_on_map_.size() < model_->graph.places.size()) graph = of_map;
  }
  if (recogniser_ && graph.places == graph_.places && graph.transitions == graph_.transitions) {
    return;
  }
  graph_ = graph;
  recogniser_ = std::make_unique<Recogniser>(*model_, graph_, params_.recogniser);
  supervision_.setGraph(graph_);
}

void SemanticLocalizationServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  if (!map_error_.empty()) addRemark(status, DiagnosticStatus::ERROR, map_error_);
  if (!recogniser_) {
    addRemark(status, DiagnosticStatus::WARN, "nothing has been learnt");
  } else {
    addRemark(status, DiagnosticStatus::OK, last_place_.empty() ? "place unknown" : last_place_);
  }
  if (!autosave_error_.empty()) addRemark(status, DiagnosticStatus::ERROR, autosave_error_);
  const std::size_t unsaved = learner_->frames().size() - saved_frames_;
  if (unsaved > 0) {
    addRemark(status, DiagnosticStatus::OK,
              std::to_string(unsaved) + " frames gathered, not saved yet");
  }
  if (received_ == reported_received_) {
    addRemark(status, DiagnosticStatus::WARN, "no images on " + image_topic_);
  }
  if (dropped_ > reported_dropped_) {
    addRemark(status, DiagnosticStatus::WARN, "images dropped: " + last_drop_);
  }
  if (!not_on_map_.empty()) {
    addRemark(status, DiagnosticStatus::WARN,
              std::to_string(not_on_map_.size()) + " places are not on the map");
  }
  reported_received_ = received_;
  reported_dropped_ = dropped_;
  addValue(status, "descriptor", model_->descriptor);
  addValue(status, "places", model_->graph.places.size());
  addValue(status, "signatures", model_->samples.count());
  addValue(status, "places renamed", renamed_);
  addValue(status, "places of the map", map_ ? map_->places.size() : 0);
  addValue(status, "places not on the map", not_on_map_.size());
  addValue(status, "images received", received_);
  addValue(status, "images used", used_);
  addValue(status, "images waiting", waiting_.size());
  addValue(status, "images dropped", dropped_);
  for (const auto& [reason, count] : drops_) addValue(status, "dropped: " + reason, count);
  addValue(status, "last dropped", last_drop_);
  addValue(status, "last frame [ms]", frame_ms_);
  addValue(status, "learning", learning_);
  addValue(status, "frames learnt", learner_->frames().size());
  addValue(status, "frames trained", trained_frames_);
  addValue(status, "training", training_.busy());
  addValue(status, "trainings", trainings_);
  if (!training_error_.empty()) addValue(status, "last training", training_error_);
  supervision_.report(status);
}

}  // namespace selovis

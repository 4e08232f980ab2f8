#include "selovis/ros/semantic_localization_server.hpp"

#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"
#include "selovis/learning/error_source.hpp"
#include "selovis/places/topological_places.hpp"

namespace selovis {

namespace {

constexpr int kManyWithoutOdometry = 10;  // frames on end

}  // namespace

SemanticLocalizationServer::SemanticLocalizationServer(const ros::NodeHandle& nh,
                                                       const ros::NodeHandle& private_nh)
    : log_name_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadParams)),
      poses_(params_.frame_ids),
      supervision_(nh, private_nh, params_.supervision, poses_, log_name_),
      publisher_(nh, params_.marker_height) {
  const auto model = PlaceLearning::firstModel(params_, log_name_);
  const PlaceFilterKind filter = params_.recognizer.filter.kind;
  const bool exemplars = comparesExemplars(model->classifier.kernel);
  if (filter == PlaceFilterKind::kPoses && !exemplars) {
    throw hyselam::InputError("parameter 'filter'", "",
                              "'poses' needs a model with the kernel fusion or exemplar");
  }
  const bool filters_poses =
      filter == PlaceFilterKind::kPoses || (filter == PlaceFilterKind::kAuto && exemplars);
  withSource("parameter 'model'", [&] { updateRecognizer(*model, true); });
  learning_ = std::make_unique<PlaceLearning>(
      nh, private_nh, params_.learning, params_.model, model, log_name_,
      [this](const std::shared_ptr<const PlaceModel>& learned) {
        updateRecognizer(*learned, true);
      },
      [this] { return supervision_.memory(); });
  const ImageInput::Requirements required{model->makeDescriptor()->requiredReadings(),
                                          filters_poses && !params_.frame_ids.odom.empty()};
  const LearnerParams& camera = params_.learning.learner;
  input_ = std::make_unique<ImageInput>(
      nh, params_.input, required, CameraFov{camera.horizontal_fov, camera.vertical_fov}, poses_,
      log_name_,
      [this](const cv::Mat& image, const SensorReadings& readings, const std_msgs::Header& header) {
        onImage(image, readings, header);
      },
      [this] { onTimeJump(); });
  // Last: a nodelet's queue is served while its constructor still runs.
  ros::NodeHandle node = nh;
  map_subscriber_ = node.subscribe("topological_map", 2, &SemanticLocalizationServer::onMap, this);
  learning_->advertise();
  input_->subscribe();
  supervision_.subscribe();
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": visual places", params_.diagnostic_period,
      [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
}

void SemanticLocalizationServer::onImage(const cv::Mat& image, const SensorReadings& readings,
                                         const std_msgs::Header& header) {
  if (recognizer_) {
    const ros::WallTime begin = ros::WallTime::now();
    without_odometry_ = readings.odometry ? 0 : without_odometry_ + 1;
    const Recognition recognition = recognizer_->update(image, readings);
    frame_ms_ = 1e3 * (ros::WallTime::now() - begin).toSec();
    if (map_ && recognition.descriptive && !recognition.novel) {
      supervision_.update(*recognizer_, *map_, header);
    }
    publisher_.publish(recognition, *recognizer_, header, map_.get(), supervision_.kidnapped());
  }
  // What a rejected pose says of the place is not learned.
  if (!supervision_.kidnapped()) learning_->add(image, readings, header, poses_, input_->fov());
}

void SemanticLocalizationServer::onTimeJump() {
  if (recognizer_) recognizer_->reset();
  if (!transitions_.places.empty()) supervision_.setModel(learning_->model(), transitions_, true);
}

void SemanticLocalizationServer::onMap(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg) {
  std::vector<PlaceRenaming> renamings;
  try {
    auto map = std::make_shared<const hyselam_topo::AugmentedTopologicalMap>(
        hyselam_topo::fromMsg(*msg, "topological_map"));
    if (map_) renamings = renamedPlaces(*map_, *map);
    map_ = std::move(map);
    map_error_.clear();
  } catch (const std::exception& e) {
    map_error_ = e.what();  // the map before it stays in use
    ROS_ERROR_STREAM(log_name_ << " not used: " << e.what());
    return;
  }
  const PlaceTransitions before = transitions_;
  learning_->setMap(map_, renamings);
  updateRecognizer(learning_->model(), false);
  if (!(before.places == transitions_.places && before.pairs == transitions_.pairs) &&
      !unmapped_places_.empty()) {
    ROS_WARN_STREAM(log_name_ << " " << unmapped_places_.size()
                              << " of the learned places are not on the map, '"
                              << unmapped_places_.front() << "' among them");
  }
}

void SemanticLocalizationServer::updateRecognizer(const PlaceModel& model, bool always) {
  if (model.samples.count() == 0) return;
  PlaceTransitions transitions = model.transitions;
  unmapped_places_.clear();
  if (map_) {
    const PlaceTransitions of_map = transitionsOf(*map_);
    unmapped_places_ = missingPlaces(of_map, model.transitions.places);
    // A map with none of the places has no transitions between them.
    if (unmapped_places_.size() < model.transitions.places.size()) {
      transitions = reordered(of_map, model.transitions.places);
    }
  }
  if (recognizer_ && !always && transitions.places == transitions_.places &&
      transitions.pairs == transitions_.pairs) {
    return;
  }
  recognizer_ = std::make_unique<ImageRecognizer>(model, transitions, params_.recognizer);
  if (!recognizer_->posesProblem().empty()) {
    ROS_WARN_STREAM(log_name_ << " frames are filtered by places alone: the learned frames "
                              << recognizer_->posesProblem());
  }
  transitions_ = std::move(transitions);
  supervision_.setModel(model, transitions_, !always);
}

void SemanticLocalizationServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  if (!map_error_.empty()) addRemark(status, DiagnosticStatus::ERROR, map_error_);
  if (!recognizer_) {
    addRemark(status, DiagnosticStatus::WARN, "nothing has been learnt");
  } else {
    const std::string& place = publisher_.lastPlace();
    addRemark(status, DiagnosticStatus::OK, place.empty() ? "place unknown" : place);
  }
  if (!unmapped_places_.empty()) {
    addRemark(status, DiagnosticStatus::WARN,
              std::to_string(unmapped_places_.size()) + " places are not on the map");
  }
  if (params_.recognizer.filter.kind == PlaceFilterKind::kPoses &&
      without_odometry_ >= kManyWithoutOdometry) {
    addRemark(status, DiagnosticStatus::WARN,
              "the filter poses has no odometry: 'auto' or 'bayes' does better without");
  }
  learning_->report(status);
  addValue(status, "places of the map", map_ ? map_->places.size() : 0);
  addValue(status, "places not on the map", unmapped_places_.size());
  input_->report(status);
  addValue(status, "last frame [ms]", frame_ms_);
  supervision_.report(status);
}

}  // namespace selovis

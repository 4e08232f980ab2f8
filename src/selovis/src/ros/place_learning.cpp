#include "selovis/ros/place_learning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "selovis/places/topological_places.hpp"

namespace selovis {
namespace {

constexpr double kMaxPlaceAge = 3.0;   // [s] of a PlaceState against an image
constexpr double kPollPeriod = 0.005;  // [s] of wall time, for the end of a training

/// Of the map's first signature that is not of this one; empty if there is none.
std::string otherDescriptor(const hyselam_topo::AugmentedTopologicalMap& map,
                            const std::string& descriptor) {
  for (const auto& place : map.places) {
    for (const auto& signature : place.signatures) {
      if (signature.appearance.type != descriptor) return signature.appearance.type;
    }
  }
  return "";
}

}  // namespace

PlaceLabels::PlaceLabels(ros::NodeHandle nh, double min_border_distance)
    : min_border_distance_(min_border_distance) {
  subscriber_ = nh.subscribe<hyselam_msgs::PlaceState>(
      "place", 20, [this](const hyselam_msgs::PlaceState::ConstPtr& msg) { place_ = msg; });
}

std::string PlaceLabels::labelAt(const std::optional<hyselam::Pose2>& base, const ros::Time& stamp,
                                 const hyselam_topo::AugmentedTopologicalMap* map) const {
  if (place_ && std::abs((place_->header.stamp - stamp).toSec()) <= kMaxPlaceAge) {
    if (place_->place == 0 || place_->in_doorway) return "";
    if (!place_->name.empty()) return place_->name;
    const auto* place = map != nullptr ? map->findPlace(place_->place) : nullptr;
    return place != nullptr ? hyselam_topo::nameOf(*place) : "";
  }
  if (map == nullptr || !base) return "";
  const auto near = placesNear(*map, {base->x, base->y}, min_border_distance_);
  return near.size() == 1 ? near.front() : "";
}

std::optional<hyselam::Pose2> PlaceLabels::lastPose() const {
  if (!place_) return {};
  return hyselam::Pose2{place_->pose.x, place_->pose.y, place_->pose.theta};
}

std::shared_ptr<const PlaceModel> PlaceLearning::firstModel(
    const SemanticLocalizationParams& params, const std::string& log_name) {
  const std::string& saved = params.learning.save_model;
  if (holdsPlaceModel(saved)) {
    if (!params.model.empty() && params.model != saved) {
      ROS_WARN_STREAM(log_name << " continues with the model in " << saved << ", not with "
                               << params.model);
    }
    return std::make_shared<PlaceModel>(loadPlaceModel(saved));
  }
  if (!params.model.empty()) return std::make_shared<PlaceModel>(loadPlaceModel(params.model));
  TrainingOptions options;
  options.descriptor = params.descriptor;
  options.classifier.kernel = params.kernel;
  return std::make_shared<PlaceModel>(untrainedPlaceModel(options));
}

PlaceLearning::PlaceLearning(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                             const LearningParams& params, std::string model_directory,
                             std::shared_ptr<const PlaceModel> model, std::string log_name,
                             ModelHandler on_model, Memory memory)
    : private_nh_(private_nh),
      params_(params),
      model_directory_(std::move(model_directory)),
      log_name_(std::move(log_name)),
      on_model_(std::move(on_model)),
      memory_(std::move(memory)),
      model_(std::move(model)),
      labels_(nh, params.min_border_distance),
      learner_(model_, params.learner),
      camera_(params.learner),
      learning_(params.learn) {
  timer_ = private_nh_.createWallTimer(
      ros::WallDuration(kPollPeriod), [this](const ros::WallTimerEvent&) { takeTrained(); }, false,
      false);
}

PlaceLearning::~PlaceLearning() {
  timer_.stop();
  for (auto& service : services_) service.shutdown();
  if (!params_.autosave || !holdsPlaceModel(params_.save_model)) return;
  try {
    saveMemory(params_.save_model);
  } catch (const std::exception& e) {
    ROS_WARN_STREAM(log_name_ << " where the camera errs was not saved: " << e.what());
  }
}

void PlaceLearning::advertise() {
  using Self = PlaceLearning;
  services_ = {private_nh_.advertiseService("start_learning", &Self::onStart, this),
               private_nh_.advertiseService("stop_learning", &Self::onStop, this),
               private_nh_.advertiseService("retrain", &Self::onRetrain, this),
               private_nh_.advertiseService("save", &Self::onSave, this)};
}

void PlaceLearning::add(const cv::Mat& image, const SensorReadings& readings,
                        const std_msgs::Header& header, const CameraPoses& poses,
                        const CameraFov& fov) {
  camera_.horizontal_fov = fov.horizontal;
  camera_.vertical_fov = fov.vertical;
  if (!learning_) return;
  const auto base = poses.baseInMap(header.stamp);
  const std::string label = labels_.labelAt(base, header.stamp, map_.get());
  if (label.empty()) return;
  auto camera = poses.cameraInMap(header.frame_id, header.stamp);
  if (!camera) {
    const auto pose = base ? base : labels_.lastPose();
    if (!pose) return;
    camera = CameraPoses::CameraPose{*pose, 0.0};
  }
  if (!learner_.add(image, readings, label, camera->pose, camera->height, header.stamp.toSec())) {
    return;
  }
  if (params_.retrain_every > 0 &&
      learner_.frames().size() - frames_.tried >= static_cast<std::size_t>(params_.retrain_every)) {
    std::string message;
    startTraining(message);
  }
}

void PlaceLearning::setModel(std::shared_ptr<const PlaceModel> model) {
  model_ = std::move(model);
  try {
    on_model_(model_);
  } catch (const hyselam::Error& e) {
    training_error_ = e.what();
    ROS_ERROR_STREAM(log_name_ << " the new model is not used: " << e.what());
  }
}

void PlaceLearning::setMap(std::shared_ptr<const Map> map,
                           const std::vector<PlaceRenaming>& renamings) {
  map_ = std::move(map);
  if (!renamings.empty()) renamePlaces(renamings);
  if (model_->samples.count() == 0 && !map_learned_) learnFromMap();
}

void PlaceLearning::learnFromMap() {
  std::vector<LearnedFrame> frames = framesFromMap(*map_, *model_);
  const std::size_t count = frames.size();
  if (count == 0) {
    const std::string other = otherDescriptor(*map_, model_->descriptor);
    if (!other.empty()) {
      ROS_WARN_STREAM_ONCE(log_name_ << " the map's signatures are of descriptor '" << other
                                     << "', not of '" << model_->descriptor
                                     << "': nothing is learned from them");
    }
    return;
  }
  if (!train(std::move(frames))) return;
  map_learned_ = true;
  frames_.in_training = frames_.trained;
  ROS_INFO_STREAM(log_name_ << " learning from " << count << " signatures of the map");
}

bool PlaceLearning::startTraining(std::string& message) {
  const auto& all = learner_.frames();
  std::vector<LearnedFrame> fresh(all.begin() + static_cast<std::ptrdiff_t>(frames_.trained),
                                  all.end());
  if (fresh.empty()) {
    message = "no frames have been collected since the last training";
    return false;
  }
  const std::size_t count = fresh.size();
  if (!train(std::move(fresh))) {
    message = "training is under way";
    return false;
  }
  frames_.in_training = frames_.tried = frames_.trained + count;
  message = "training with " + std::to_string(count) + " new frames";
  return true;
}

bool PlaceLearning::train(std::vector<LearnedFrame> frames) {
  const auto done = [this](const BackgroundTraining::Outcome& outcome) {
    Trained trained{outcome, false, ""};
    if (outcome.model && params_.autosave && !params_.save_model.empty()) {
      trained.save_error = trySave(*outcome.model);
      trained.saved = trained.save_error.empty();
    }
    const std::lock_guard<std::mutex> lock(trained_mutex_);
    trained_ = std::move(trained);
  };
  if (!training_.start(model_, std::move(frames), done)) return false;
  timer_.start();
  return true;
}

std::string PlaceLearning::trySave(const PlaceModel& model) {
  try {
    const std::lock_guard<std::mutex> lock(save_mutex_);
    savePlaceModel(model, params_.save_model);
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

void PlaceLearning::renamePlaces(const std::vector<PlaceRenaming>& renamings) {
  learner_.rename(renamings);
  bool in_training = training_.busy();
  {
    const std::lock_guard<std::mutex> lock(trained_mutex_);
    in_training = in_training || trained_;
  }
  if (in_training) {
    renamed_in_training_.insert(renamed_in_training_.end(), renamings.begin(), renamings.end());
  }
  renameModel(renamings);
}

void PlaceLearning::renameModel(const std::vector<PlaceRenaming>& renamings) {
  PlaceTransitions transitions = model_->transitions;
  const std::size_t changed = selovis::renamePlaces(renamings, transitions);
  if (changed == 0) return;
  renamed_ += changed;
  auto named = std::make_shared<PlaceModel>(*model_);
  named->transitions = std::move(transitions);
  // Of the same frames: what the camera was found to err in since still holds.
  const ReliabilityMemory* memory = memory_ ? memory_() : nullptr;
  if (memory != nullptr) named->reliability = *memory;
  setModel(std::move(named));
  ROS_INFO_STREAM(log_name_ << " the model follows new names of places, '" << renamings.back().to
                            << "' among them");
  if (!params_.autosave || params_.save_model.empty()) return;
  autosave_error_ = trySave(*model_);
  if (!autosave_error_.empty()) ROS_ERROR_STREAM(log_name_ << " not saved: " << autosave_error_);
}

void PlaceLearning::takeTrained() {
  const bool busy = training_.busy();  // before the outcome is looked for: it comes first
  std::optional<Trained> trained;
  {
    const std::lock_guard<std::mutex> lock(trained_mutex_);
    trained.swap(trained_);
  }
  if (!trained) {
    if (!busy) timer_.stop();
    return;
  }
  const std::vector<PlaceRenaming> renamings = std::exchange(renamed_in_training_, {});
  training_error_ = trained->outcome.error;
  if (!trained->outcome.model) {
    ROS_WARN_STREAM(log_name_ << " not trained: " << trained->outcome.error);
    return;
  }
  frames_.trained = frames_.in_training;
  ++trainings_;
  setModel(trained->outcome.model);
  ROS_INFO_STREAM(log_name_ << " trained with " << trained->outcome.frames
                            << " new frames: " << model_->transitions.places.size() << " places"
                            << (trained->saved ? ", saved" : ""));
  if (trained->saved) frames_.saved = std::max(frames_.saved, frames_.trained);
  autosave_error_ = trained->save_error;
  if (!autosave_error_.empty()) ROS_ERROR_STREAM(log_name_ << " not saved: " << autosave_error_);
  renameModel(renamings);
}

bool PlaceLearning::onStart(Trigger::Request&, Trigger::Response& response) {
  learning_ = true;
  response.success = true;
  response.message = "learning";
  return true;
}

bool PlaceLearning::onStop(Trigger::Request&, Trigger::Response& response) {
  learning_ = false;
  response.success = true;
  response.message = std::to_string(learner_.frames().size()) + " frames collected";
  return true;
}

bool PlaceLearning::onRetrain(Trigger::Request&, Trigger::Response& response) {
  response.success = startTraining(response.message);
  return true;
}

std::string PlaceLearning::saveModel() {
  const std::string directory = params_.save_model.empty() ? model_directory_ : params_.save_model;
  if (directory.empty()) return "";
  if (model_->samples.count() == 0) {
    throw hyselam::InputError(directory, "", "nothing has been learnt");
  }
  {
    const std::lock_guard<std::mutex> lock(save_mutex_);
    savePlaceModel(*model_, directory);
  }
  saveMemory(directory);
  autosave_error_.clear();
  frames_.saved = std::max(frames_.saved, frames_.trained);
  return std::to_string(model_->transitions.places.size()) + " places written to " + directory;
}

void PlaceLearning::saveMemory(const std::string& directory) {
  const ReliabilityMemory* memory = memory_();
  if (memory == nullptr || memory->size() == 0) return;
  const std::lock_guard<std::mutex> lock(save_mutex_);
  saveReliability(*model_, *memory, directory);
}

std::string PlaceLearning::saveMap() {
  if (params_.save_map.empty()) return "";
  if (!map_) throw hyselam::InputError(params_.save_map, "", "no topological map has come");
  Map map = *map_;
  const std::size_t unknown = storeSignatures(learner_.frames(), *model_, camera_, map);
  hyselam_topo::saveXml(params_.save_map, map);
  frames_.saved = learner_.frames().size();
  return std::to_string(learner_.frames().size() - unknown) + " frames written to " +
         params_.save_map;
}

bool PlaceLearning::onSave(Trigger::Request&, Trigger::Response& response) {
  try {
    response.message = saveModel();
    const std::string map = saveMap();
    response.message += (response.message.empty() || map.empty() ? "" : "; ") + map;
    if (response.message.empty()) {
      throw hyselam::InputError("parameter 'save_model'", "", "is empty: nowhere to save");
    }
    response.success = true;
    ROS_INFO_STREAM(log_name_ << " " << response.message);
  } catch (const std::exception& e) {
    response.success = false;
    response.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved: " << e.what());
  }
  return true;
}

void PlaceLearning::report(diagnostic_msgs::DiagnosticStatus& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  if (!autosave_error_.empty()) addRemark(status, DiagnosticStatus::ERROR, autosave_error_);
  const std::size_t collected = learner_.frames().size();
  if (collected > frames_.saved) {
    addRemark(status, DiagnosticStatus::OK,
              std::to_string(collected - frames_.saved) + " frames collected, not saved yet");
  }
  addValue(status, "descriptor", model_->descriptor);
  addValue(status, "places", model_->transitions.places.size());
  addValue(status, "signatures", model_->samples.count());
  addValue(status, "places renamed", renamed_);
  addValue(status, "learning", learning_);
  addValue(status, "frames collected", collected);
  addValue(status, "frames trained", frames_.trained);
  addValue(status, "training", training_.busy());
  addValue(status, "trainings", trainings_);
  if (!training_error_.empty()) addValue(status, "last training", training_error_);
}

}  // namespace selovis

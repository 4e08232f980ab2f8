// The part of the server that learns places while the robot drives (7.3.2).
#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "selovis/ros/semantic_localization_server.hpp"

namespace selovis {
namespace {

constexpr double kPlaceAge = 3.0;  // [s] a PlaceState so old is still that of the image

}  // namespace

std::string SemanticLocalizationServer::labelOf(const std::optional<hyselam::Pose2>& base,
                                                const ros::Time& stamp) const {
  if (place_ && std::abs((place_->header.stamp - stamp).toSec()) <= kPlaceAge) {
    if (place_->place == 0 || place_->in_doorway) return "";
    if (!place_->name.empty()) return place_->name;
    const auto* place = map_ ? map_->findPlace(place_->place) : nullptr;
    return place != nullptr ? hyselam_topo::nameOf(*place) : "";
  }
  if (!map_ || !base) return "";
  const auto near = placesNear(*map_, {base->x, base->y}, params_.border);
  return near.size() == 1 ? near.front() : "";
}

void SemanticLocalizationServer::keep(const cv::Mat& image, const Readings& readings,
                                      const std_msgs::Header& header) {
  if (supervision_.kidnapped()) return;  // what the pose says is not believed
  const auto base = poseInMap(params_.base_frame_id, header.stamp);
  const std::string label = labelOf(base, header.stamp);
  if (label.empty()) return;
  double height = 0.0;
  auto camera = poseInMap(header.frame_id, header.stamp, &height);
  if (!camera) camera = base;
  if (!camera && place_)
    camera = hyselam::Pose2{place_->pose.x, place_->pose.y, place_->pose.theta};
  if (!camera) return;
  if (!learner_->add(image, readings, label, *camera, height, header.stamp.toSec())) return;
  if (params_.retrain_every > 0 && learner_->frames().size() - tried_frames_ >=
                                       static_cast<std::size_t>(params_.retrain_every)) {
    startTraining(nullptr);
  }
}

bool SemanticLocalizationServer::startTraining(std::string* message) {
  const auto& all = learner_->frames();
  std::vector<LearntFrame> fresh(all.begin() + static_cast<std::ptrdiff_t>(trained_frames_),
                                 all.end());
  const auto tell = [&](const std::string& text) {
    if (message != nullptr) *message = text;
  };
  if (fresh.empty()) {
    tell("no frames have been learnt since the last training");
    return false;
  }
  const std::size_t count = fresh.size();
  if (!train(std::move(fresh))) {
    tell("training is under way");
    return false;
  }
  timer_.start();
  training_frames_ = trained_frames_ + count;
  tried_frames_ = training_frames_;
  tell("training with " + std::to_string(count) + " new frames");
  return true;
}

bool SemanticLocalizationServer::train(std::vector<LearntFrame> frames) {
  return training_.start(model_, std::move(frames), [this](const BackgroundTraining::Outcome& o) {
    Trained trained{o, false, ""};
    if (o.model && params_.autosave && !params_.save_model.empty()) {
      trained.save_error = trySave(*o.model);
      trained.saved = trained.save_error.empty();
    }
    const std::lock_guard<std::mutex> lock(trained_mutex_);
    trained_ = std::move(trained);
  });
}

std::string SemanticLocalizationServer::trySave(const Model& model) {
  try {
    const std::lock_guard<std::mutex> lock(save_mutex_);
    saveModel(model, params_.save_model);
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

void SemanticLocalizationServer::rename(const std::vector<Renaming>& renamings) {
  learner_->rename(renamings);
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

void SemanticLocalizationServer::renameModel(const std::vector<Renaming>& renamings) {
  PlaceGraph graph = model_->graph;
  const std::size_t changed = selovis::rename(renamings, &graph);
  if (changed == 0) return;
  renamed_ += changed;
  auto named = std::make_shared<Model>(*model_);
  named->graph = std::move(graph);
  useModel(std::move(named));
  ROS_INFO_STREAM(who_ << " what was learnt goes with places that are called otherwise now, '"
                       << renamings.back().to << "' among them");
  if (!params_.autosave || params_.save_model.empty()) return;
  autosave_error_ = trySave(*model_);
  if (!autosave_error_.empty()) ROS_ERROR_STREAM(who_ << " not saved: " << autosave_error_);
}

void SemanticLocalizationServer::takeTrained() {
  std::optional<Trained> trained;
  {
    const std::lock_guard<std::mutex> lock(trained_mutex_);
    trained.swap(trained_);
  }
  if (!trained) return;
  const std::vector<Renaming> renamings = std::exchange(renamed_in_training_, {});
  training_error_ = trained->outcome.error;
  if (!trained->outcome.model) {
    ROS_WARN_STREAM(who_ << " not trained: " << trained->outcome.error);
    return;
  }
  trained_frames_ = training_frames_;
  ++trainings_;
  useModel(trained->outcome.model);
  ROS_INFO_STREAM(who_ << " trained with " << trained->outcome.frames
                       << " new frames: " << model_->graph.places.size() << " places"
                       << (trained->saved ? ", saved" : ""));
  if (trained->saved) saved_frames_ = std::max(saved_frames_, trained_frames_);
  autosave_error_ = trained->save_error;
  if (!autosave_error_.empty()) ROS_ERROR_STREAM(who_ << " not saved: " << autosave_error_);
  renameModel(renamings);
}

bool SemanticLocalizationServer::onStartLearning(Trigger::Request&, Trigger::Response& response) {
  learning_ = true;
  response.success = true;
  response.message = "learning";
  return true;
}

bool SemanticLocalizationServer::onStopLearning(Trigger::Request&, Trigger::Response& response) {
  learning_ = false;
  response.success = true;
  response.message = std::to_string(learner_->frames().size()) + " frames learnt";
  return true;
}

bool SemanticLocalizationServer::onRetrain(Trigger::Request&, Trigger::Response& response) {
  response.success = startTraining(&response.message);
  return true;
}

bool SemanticLocalizationServer::onSave(Trigger::Request&, Trigger::Response& response) {
  try {
    const std::string directory = params_.save_model.empty() ? params_.model : params_.save_model;
    if (directory.empty() && params_.save_map.empty()) {
      throw hyselam::InputError("parameter 'save_model'", "", "is empty: nowhere to save");
    }
    if (!directory.empty()) {
      if (model_->samples.count() == 0) {
        throw hyselam::InputError(directory, "", "nothing has been learnt");
      }
      {
        const std::lock_guard<std::mutex> lock(save_mutex_);
        saveModel(*model_, directory);
      }
      autosave_error_.clear();
      saved_frames_ = std::max(saved_frames_, trained_frames_);
      response.message =
          std::to_string(model_->graph.places.size()) + " places written to " + directory;
    }
    if (!params_.save_map.empty()) {
      if (!map_) throw hyselam::InputError(params_.save_map, "", "no topological map has come");
      hyselam_topo::AugmentedTopologicalMap map = *map_;
      LearnerParams taken_with = params_.learner;
      if (aperture_) {
        taken_with.aperture_x = *aperture_;
        taken_with.aperture_y = aperture_y_;
      }
      const std::size_t lost = store(learner_->frames(), *model_, taken_with, &map);
      hyselam_topo::saveXml(params_.save_map, map);
      saved_frames_ = learner_->frames().size();
      response.message += (response.message.empty() ? "" : "; ") +
                          std::to_string(learner_->frames().size() - lost) + " frames written to " +
                          params_.save_map;
    }
    response.success = true;
    ROS_INFO_STREAM(who_ << " " << response.message);
  } catch (const std::exception& e) {
    response.success = false;
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not saved: " << e.what());
  }
  return true;
}

}  // namespace selovis

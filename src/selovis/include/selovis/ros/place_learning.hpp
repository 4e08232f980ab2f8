// Learning places while the robot drives: collects frames, trains in the background, saves.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <hyselam_msgs/PlaceState.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"
#include "selovis/learning/background_training.hpp"
#include "selovis/ros/camera_poses.hpp"
#include "selovis/ros/image_input.hpp"
#include "selovis/ros/parameters.hpp"

namespace selovis {

/// Which place an image is learned as: that of the topic `place`, else that of the robot's pose on
/// the map.
class PlaceLabels {
 public:
  PlaceLabels(ros::NodeHandle nh, double min_border_distance);

  /// Empty: in a doorway, too near to another place, or not known.
  std::string labelAt(const std::optional<hyselam::Pose2>& base, const ros::Time& stamp,
                      const hyselam_topo::AugmentedTopologicalMap* map) const;
  /// By the topic `place`, however old.
  std::optional<hyselam::Pose2> lastPose() const;

 private:
  double min_border_distance_;
  hyselam_msgs::PlaceState::ConstPtr place_;
  ros::Subscriber subscriber_;
};

/// Services: `~start_learning`, `~stop_learning`, `~retrain`, `~save`. All callbacks on the queue
/// of the node handles, one at a time; training and saving after it have a thread of their own.
class PlaceLearning {
 public:
  using Map = hyselam_topo::AugmentedTopologicalMap;
  /// Gets each new model: trained, or with other names of places.
  using ModelHandler = std::function<void(std::shared_ptr<const PlaceModel>)>;
  /// Where the camera was found to err with the present model, to be saved with it; may be null.
  using Memory = std::function<const ReliabilityMemory*()>;

  /// The model to begin with: that of `save_model`, else `model`, else one without places.
  /// @throws hyselam::InputError, hyselam::ParameterError.
  static std::shared_ptr<const PlaceModel> firstModel(const SemanticLocalizationParams& params,
                                                      const std::string& log_name);

  /// @param model_directory where ~save writes without `save_model`. @param log_name begins what is
  /// logged.
  PlaceLearning(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                const LearningParams& params, std::string model_directory,
                std::shared_ptr<const PlaceModel> model, std::string log_name,
                ModelHandler on_model, Memory memory);
  /// Ends the callbacks, then the training. With `autosave` and `save_model` the memory is saved.
  ~PlaceLearning();

  /// From now on the services are served.
  void advertise();

  /// An image of a robot whose pose is not rejected; kept if learning is on and its place is known.
  /// @throws hyselam::InputError (Descriptor::compute).
  void add(const cv::Mat& image, const SensorReadings& readings, const std_msgs::Header& header,
           const CameraPoses& poses, const CameraFov& fov);
  /// Learned frames follow the new names of their places; without a model the signatures of the map
  /// are learned.
  void setMap(std::shared_ptr<const Map> map, const std::vector<PlaceRenaming>& renamings);

  const PlaceModel& model() const { return *model_; }
  void report(diagnostic_msgs::DiagnosticStatus& status) const;

 private:
  using Trigger = std_srvs::Trigger;
  struct Trained {
    BackgroundTraining::Outcome outcome;
    bool saved = false;      ///< in `save_model`
    std::string save_error;  ///< empty: saved, or not tried
  };
  /// Numbers of collected frames.
  struct FrameCounts {
    std::size_t trained = 0;      // in the model
    std::size_t in_training = 0;  // in the model once the running training ends
    std::size_t tried = 0;        // when training began last, whether it succeeded or not
    std::size_t saved = 0;        // in the saved model or map
  };

  void setModel(std::shared_ptr<const PlaceModel> model);
  void renamePlaces(const std::vector<PlaceRenaming>& renamings);
  /// The model with new names, saved if that is wanted.
  void renameModel(const std::vector<PlaceRenaming>& renamings);
  void learnFromMap();
  /// Trains with the frames that the model does not have yet; `message` receives a
  /// description of what was started, or the reason why nothing was.
  bool startTraining(std::string& message);
  /// In the other thread, which saves the model as well. False if it is busy.
  bool train(std::vector<LearnedFrame> frames);
  void takeTrained();
  /// Into `save_model`; returns the error, or nothing.
  std::string trySave(const PlaceModel& model);
  std::string saveModel();
  /// Of the model that was saved there.
  void saveMemory(const std::string& directory);
  std::string saveMap();

  bool onStart(Trigger::Request&, Trigger::Response& response);
  bool onStop(Trigger::Request&, Trigger::Response& response);
  bool onRetrain(Trigger::Request&, Trigger::Response& response);
  bool onSave(Trigger::Request&, Trigger::Response& response);

  ros::NodeHandle private_nh_;
  const LearningParams params_;
  const std::string model_directory_, log_name_;
  const ModelHandler on_model_;
  const Memory memory_;
  std::shared_ptr<const PlaceModel> model_;
  std::shared_ptr<const Map> map_;
  PlaceLabels labels_;
  Learner learner_;
  LearnerParams camera_;  // the learner's, with the field of view of the camera
  bool learning_;
  FrameCounts frames_;
  std::mutex trained_mutex_;
  std::optional<Trained> trained_;  // by the other thread
  std::vector<PlaceRenaming> renamed_in_training_;
  std::mutex save_mutex_;  // of the directory `save_model`
  std::string training_error_, autosave_error_;
  std::size_t trainings_ = 0, renamed_ = 0;
  bool map_learned_ = false;
  ros::WallTimer timer_;  // runs while a training does
  std::vector<ros::ServiceServer> services_;
  BackgroundTraining training_;  // last: its thread ends first
};

}  // namespace selovis

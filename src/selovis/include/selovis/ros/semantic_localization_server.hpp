// The server of the nodelet SemanticLocalization: images in, the recognized place out; learns
// places while the robot drives, and tests the pose of the localization.
#pragma once

#include <hyselam_msgs/AugmentedTopologicalMap.h>
#include <ros/ros.h>

#include <memory>
#include <string>
#include <vector>

#include "hyselam_common/ros/diagnostics.hpp"
#include "selovis/ros/camera_poses.hpp"
#include "selovis/ros/image_input.hpp"
#include "selovis/ros/parameters.hpp"
#include "selovis/ros/place_learning.hpp"
#include "selovis/ros/place_publisher.hpp"
#include "selovis/ros/pose_supervision.hpp"

namespace selovis {

/// Topics, services and parameters: see README.md. Callbacks run on the queue of `nh`, one at a
/// time; training has a thread of its own.
class SemanticLocalizationServer {
 public:
  /// Reads and checks the parameters of `private_nh` and the model, before anything is subscribed.
  /// @throws hyselam::ParameterError; hyselam::InputError for the model.
  SemanticLocalizationServer(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

 private:
  void onMap(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg);
  void onImage(const cv::Mat& image, const SensorReadings& readings,
               const std_msgs::Header& header);
  void onTimeJump();
  /// A recognizer for the model, with the map's transitions if it has any of the model's places.
  /// @param always also if the transitions are those of the present one.
  void updateRecognizer(const PlaceModel& model, bool always);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  const std::string log_name_;
  const SemanticLocalizationParams params_;
  std::shared_ptr<const hyselam_topo::AugmentedTopologicalMap> map_;  // null at first
  std::string map_error_;
  PlaceTransitions transitions_;  // of the model's places
  std::vector<std::string> unmapped_places_;
  std::unique_ptr<ImageRecognizer> recognizer_;  // null as long as nothing was learned
  double frame_ms_ = 0.0;
  int without_odometry_ = 0;  // the last frames
  CameraPoses poses_;
  PoseSupervision supervision_;
  PlacePublisher publisher_;
  std::unique_ptr<PlaceLearning> learning_;
  std::unique_ptr<ImageInput> input_;
  ros::Subscriber map_subscriber_;
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
};

}  // namespace selovis

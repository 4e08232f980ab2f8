// Images in, the place that the robot sees itself in out; learns places and watches over the pose.
#pragma once

#include <hyselam_msgs/AugmentedTopologicalMap.h>
#include <hyselam_msgs/PlaceState.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MagneticField.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hyselam_common/ros/diagnostics.hpp"
#include "selovis/ros/parameters.hpp"
#include "selovis/ros/pose_supervision.hpp"
#include "selovis/ros/sensor_history.hpp"

namespace selovis {

/// Topics, services and parameters: see README.md. Callbacks run on the queue of `nh`, one at a
/// time; training has a thread of its own.
class SemanticLocalizationServer {
 public:
  /// Reads and checks the parameters of `private_nh` and the model, before anything is subscribed.
  /// @throws hyselam::ParameterError; hyselam::InputError for the model.
  SemanticLocalizationServer(ros::NodeHandle nh, ros::NodeHandle private_nh);
  /// Ends the callbacks, then the training.
  ~SemanticLocalizationServer();

 private:
  struct Waiting {
    sensor_msgs::ImageConstPtr raw;  ///< or
    sensor_msgs::CompressedImage::ConstPtr compressed;
    std_msgs::Header header;
    ros::WallTime since;
  };
  struct Trained {
    BackgroundTraining::Outcome outcome;
    bool saved = false;      ///< in `save_model`
    std::string save_error;  ///< why not; empty: it was not tried, or it was saved
  };
  using Trigger = std_srvs::Trigger;

  void onImage(Waiting image);
  /// A reading may be what an image waits for.
  template <typename M>
  void onReading(SensorHistory<M>& history, const typename M::ConstPtr& reading);
  void serveWaiting();
  /// Nothing: not yet. Throws hyselam::InputError for an image whose readings do not come.
  std::optional<Readings> readingsFor(const Waiting& image) const;
  void serve(const Waiting& image, const Readings& readings);
  void publish(const Recognition& recognition, const std_msgs::Header& header);
  void keep(const cv::Mat& image, const Readings& readings, const std_msgs::Header& header);
  std::string labelOf(const std::optional<hyselam::Pose2>& base, const ros::Time& stamp) const;
  /// Nothing waits and nothing trains: the timer may rest.
  void restIfIdle();
  void drop(const std::string& reason, const std::string& detail);

  void onMap(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg);
  void useModel(std::shared_ptr<const Model> model);
  /// What was learnt of places goes with them when they get another name.
  void rename(const std::vector<Renaming>& renamings);
  /// The model in use with new names, saved if that is wanted.
  void renameModel(const std::vector<Renaming>& renamings);
  /// Into `save_model`; why not, or empty.
  std::string trySave(const Model& model);
  void rebuild();
  bool startTraining(std::string* message);
  /// In the other thread, which saves the model, too. False if it is busy.
  bool train(std::vector<LearntFrame> frames);
  void takeTrained();

  bool onStartLearning(Trigger::Request&, Trigger::Response& response);
  bool onStopLearning(Trigger::Request&, Trigger::Response& response);
  bool onRetrain(Trigger::Request&, Trigger::Response& response);
  bool onSave(Trigger::Request&, Trigger::Response& response);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  /// Of `child` in the map at that time, or half a second about it.
  std::optional<hyselam::Pose2> poseInMap(const std::string& child, const ros::Time& stamp,
                                          double* height = nullptr) const;
  std::optional<hyselam::Pose2> poseIn(const std::string& parent, const std::string& child,
                                       const ros::Time& stamp, double* height = nullptr) const;

  std::string who_;
  std::string image_topic_;
  SemanticLocalizationParams params_;
  ReadingNeeds needs_;
  std::shared_ptr<const Model> model_;
  PlaceGraph graph_;  // with the model's places
  std::vector<std::string> not_on_map_;
  std::unique_ptr<Recogniser> recogniser_;  // null as long as nothing was learnt
  std::optional<hyselam_topo::AugmentedTopologicalMap> map_;
  std::string map_error_;

  std::deque<Waiting> waiting_;
  SensorHistory<sensor_msgs::LaserScan> scans_;
  SensorHistory<sensor_msgs::Image> depths_{60};  // two seconds of a camera; each may be a megabyte
  SensorHistory<sensor_msgs::Imu> imus_;
  SensorHistory<sensor_msgs::MagneticField> fields_;
  std::optional<double> aperture_;  // of the camera, by camera_info [rad]
  double aperture_y_ = 0.0;
  ros::Time last_image_;

  bool learning_ = false;
  hyselam_msgs::PlaceState::ConstPtr place_;
  std::unique_ptr<Learner> learner_;
  std::size_t trained_frames_ = 0;  // of the learner's, in the model or in training
  std::size_t training_frames_ = 0;
  std::size_t saved_frames_ = 0;  ///< that have been written, in the model or the map
  std::size_t tried_frames_ = 0;  ///< when training began last, whatever became of it
  std::mutex trained_mutex_;
  std::optional<Trained> trained_;  // from the other thread
  std::vector<Renaming> renamed_in_training_;
  std::mutex save_mutex_;  // of the directory that models are saved to
  std::string training_error_, autosave_error_;
  std::size_t trainings_ = 0, renamed_ = 0;
  bool tried_map_ = false;  // to learn from the map's own signatures

  std::size_t received_ = 0, used_ = 0, dropped_ = 0, reported_received_ = 0, reported_dropped_ = 0;
  std::map<std::string, std::size_t> drops_;
  std::string last_drop_;
  std::string last_place_;
  double frame_ms_ = 0.0;

  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
  PoseSupervision supervision_;
  ros::Publisher place_publisher_, marker_publisher_;
  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_subscriber_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer timer_;
  /// Last: a nodelet's queue is served while its constructor still runs.
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
  BackgroundTraining training_;  // its thread ends first
};

}  // namespace selovis

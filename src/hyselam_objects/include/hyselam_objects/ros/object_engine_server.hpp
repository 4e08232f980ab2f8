// ObjectEngine: camera and words in, the object map out.
#pragma once

#include <hyselam_msgs/AugmentedTopologicalMap.h>
#include <hyselam_msgs/ObjectAnswer.h>
#include <hyselam_msgs/ObjectMapPath.h>
#include <hyselam_msgs/ObjectRequest.h>
#include <hyselam_msgs/PlaceState.h>
#include <hyselam_msgs/QueryObjects.h>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <functional>
#include <memory>
#include <optional>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_objects/fill_map.hpp"
#include "hyselam_objects/landmark_check.hpp"
#include "hyselam_objects/ros/conversions.hpp"

namespace hyselam_objects {

struct ObjectEngineParams {
  std::string map_frame = "map";
  std::string map_file;            ///< begun with if it is there, saved to; empty: neither
  std::string dictionary_file;     ///< the same for the dictionary
  bool use_points = false;         ///< input from `points`, else from the camera's images
  double period = 0.5;             ///< frames that come sooner are left out [s]
  double publish_period = 2.0;     ///< [s]
  double tf_patience = 0.2;        ///< [s]
  int views_to_learn = 8;          ///< of a thing that is shown
  double diagnostic_period = 1.0;  ///< [s]
  DetectParams detect;
  MapperParams mapper;
};

/// @throws hyselam::ParameterError.
ObjectEngineParams loadObjectEngineParams(hyselam::ParamLoader& loader);

/// Topics, services and parameters: see README.md. All callbacks run on the queue of `nh`, one at a
/// time.
class ObjectEngineServer {
 public:
  /// @throws hyselam::ParameterError; hyselam::InputError for files that cannot be used.
  ObjectEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);

 private:
  using Image = sensor_msgs::Image;

  void onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg);
  void onImages(const Image::ConstPtr& depth, const Image::ConstPtr& colour);
  void onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg);
  hyselam_msgs::ObjectAnswer answer(const std::string& text);
  void onRequest(const hyselam_msgs::ObjectRequest::ConstPtr& msg);
  void onText(const std_msgs::String::ConstPtr& msg);
  void onPlace(const hyselam_msgs::PlaceState::ConstPtr& msg);
  void onTopology(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg);
  bool onSave(hyselam_msgs::ObjectMapPath::Request& request,
              hyselam_msgs::ObjectMapPath::Response& response);
  bool onLoad(hyselam_msgs::ObjectMapPath::Request& request,
              hyselam_msgs::ObjectMapPath::Response& response);
  bool onQuery(hyselam_msgs::QueryObjects::Request& request,
               hyselam_msgs::QueryObjects::Response& response);

  bool isDue(const std_msgs::Header& header);
  using UseFrame = std::function<void(const Eigen::Isometry3d& camera_in_map)>;
  void await(const std_msgs::Header& header, UseFrame use);
  void serveWaiting();
  void refuseWithoutPose(const std::string& why);
  void look(const OrganisedCloud& cloud, PinholeCamera camera,
            const Eigen::Isometry3d& camera_in_map, const ros::Time& stamp);
  void learn(const std::vector<DetectedObject>& seen, const PinholeCamera& camera);
  void refuse(const std::string& reason);
  void publish();
  void say(const std::string& text);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string who_;
  ObjectEngineParams params_;
  ObjectMap map_;
  ObjectDictionary dictionary_;
  ObjectParser parser_;
  FillMap fill_;
  ObjectMapper mapper_;
  LandmarkWatch watch_;
  LandmarkCheck landmarks_;  ///< of the last frames
  int held_ = 0;             ///< frames in a row that the map has not been given because of them
  std::optional<hyselam_topo::AugmentedTopologicalMap> topology_;
  std::optional<PinholeCamera> camera_;

  bool all_understood_ = true;  ///< of the last text
  std::string shown_;           ///< kind that is being shown; empty: none
  std::vector<std::vector<float>> shown_views_;
  std::vector<Eigen::Vector3d> shown_sizes_;

  struct Waiting {
    std_msgs::Header header;
    UseFrame use;
    ros::WallTime since;
  };
  std::optional<Waiting> waiting_;  // for the camera's pose
  ros::Time last_frame_;
  std::size_t frames_ = 0, refused_ = 0, without_pose_ = 0, detections_ = 0;
  double seconds_ = 0.0;
  std::string error_;  ///< of the last frame; empty: it was used

  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;
  ros::Publisher map_publisher_, marker_publisher_, text_publisher_, talk_publisher_,
      answer_publisher_;
  ros::Subscriber info_, points_, text_, request_, place_, topology_subscriber_;
  std::unique_ptr<message_filters::Subscriber<Image>> depth_, colour_;
  std::unique_ptr<message_filters::TimeSynchronizer<Image, Image>> images_;
  ros::ServiceServer save_, load_, query_;
  ros::WallTimer pose_timer_, timer_;
  std::optional<hyselam::Diagnostics> diagnostics_;
};

}  // namespace hyselam_objects

// ObjectEngine: camera and words in, the object map out.
#pragma once

#include <hyselam_msgs/AugmentedTopologicalMap.h>
#include <hyselam_msgs/ObjectAnswer.h>
#include <hyselam_msgs/ObjectMapPath.h>
#include <hyselam_msgs/ObjectRequest.h>
#include <hyselam_msgs/PlaceState.h>
#include <hyselam_msgs/QueryObjects.h>
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <optional>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_objects/fill_map.hpp"
#include "hyselam_objects/landmark_check.hpp"
#include "hyselam_objects/ros/conversions.hpp"
#include "hyselam_objects/ros/frame_input.hpp"
#include "hyselam_objects/ros/map_file.hpp"
#include "hyselam_objects/shown_thing.hpp"

namespace hyselam_objects {

struct ObjectEngineParams {
  std::string map_frame = "map";
  std::string map_file;            ///< begun with if it is there, saved to; empty: neither
  double autosave_period = 10.0;   ///< of what was seen; what is told is saved at once [s]
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
  /// @throws hyselam::ParameterError; hyselam::InputError for a dictionary that cannot be used.
  ObjectEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);
  ~ObjectEngineServer();

 private:
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

  void look(const OrganisedCloud& cloud, const PinholeCamera& camera, const ros::Time& stamp);
  void learn(const std::vector<DetectedObject>& seen, const PinholeCamera& camera);
  void refuse(const std::string& reason);
  void publish();
  void say(const std::string& text);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string who_;
  ObjectEngineParams params_;
  MapFile map_file_;
  ObjectMap map_;
  ObjectDictionary dictionary_;
  ObjectParser parser_;
  FillMap fill_;
  ObjectMapper mapper_;
  LandmarkWatch watch_;
  LandmarkCheck landmarks_;  ///< of the last frames
  int held_ = 0;             ///< frames in a row that the map has not been given because of them
  std::optional<hyselam_topo::AugmentedTopologicalMap> topology_;
  ShownThing shown_;
  bool all_understood_ = true;  ///< of the last text
  std::size_t frames_ = 0, refused_ = 0, detections_ = 0;
  double seconds_ = 0.0;
  std::string error_;  ///< of the last frame; empty: it was used

  ros::Publisher map_publisher_, marker_publisher_, text_publisher_, talk_publisher_,
      answer_publisher_;
  ros::Subscriber text_, request_, place_, topology_subscriber_;
  ros::ServiceServer save_, load_, query_;
  std::optional<FrameInput> input_;
  ros::WallTimer timer_, autosave_timer_;
  std::optional<hyselam::Diagnostics> diagnostics_;
};

}  // namespace hyselam_objects

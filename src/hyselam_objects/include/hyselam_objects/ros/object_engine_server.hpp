// ObjectEngine: builds the object map from camera images and people's statements.
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

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_objects/language/fill_map.hpp"
#include "hyselam_objects/language/link_places.hpp"
#include "hyselam_objects/mapping/landmark_check.hpp"
#include "hyselam_objects/recognition/demonstrated_object.hpp"
#include "hyselam_objects/ros/conversions.hpp"
#include "hyselam_objects/ros/frame_input.hpp"
#include "hyselam_objects/ros/map_file.hpp"

namespace hyselam_objects {

struct ObjectEngineParams {
  FrameInputParams input;
  std::string map_file;            ///< loaded at the start, kept up to date; empty: none
  double autosave_period = 10.0;   ///< of detections; statements are saved at once [s]
  std::string dictionary_file;     ///< loaded at the start, saved when an object was learned
  double publish_period = 2.0;     ///< [s]
  int views_to_learn = 8;          ///< of an object that a person shows
  double diagnostic_period = 1.0;  ///< [s]
  DetectParams detection;
  MapperParams mapping;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
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
  struct Publishers {
    ros::Publisher map, markers, text, conversation, answers;
  };
  struct Services {
    ros::ServiceServer save, load, query;
  };
  struct Subscribers {
    ros::Subscriber text, request, place, topology;
  };
  struct FrameStatistics {
    std::size_t used = 0, refused = 0, detections = 0;
    double seconds = 0.0;  ///< of the last frame
    std::string error;     ///< of the last frame; empty: it was used
  };

  void advertise(ros::NodeHandle nh);
  void subscribe(ros::NodeHandle nh);
  void startTimers(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  std::optional<std::pair<std::string, Point3>> placeAt(double x, double y) const;

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

  void processFrame(const OrganizedCloud& cloud, const PinholeCamera& camera,
                    const ros::Time& stamp);
  void learnDemonstrated(const std::vector<DetectedObject>& detections,
                         const PinholeCamera& camera);
  void refuseFrame(const std::string& reason);
  void publishMap();
  void publishText(const std::string& text);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string log_name_;
  ObjectEngineParams params_;
  MapFile map_file_;
  ObjectMap map_;
  ObjectDictionary dictionary_;
  ObjectParser parser_;
  hyselam_topo::PlaceNames place_names_ = shippedPlaceNames();
  FillMap fill_map_;
  ObjectMapper mapper_;
  MapUpdateGuard guard_;
  std::optional<hyselam_topo::AugmentedTopologicalMap> topology_;
  DemonstratedObject demonstrated_;
  bool all_understood_ = true;  ///< of the last text
  FrameStatistics frames_;

  Publishers publishers_;
  Services services_;
  Subscribers subscribers_;
  std::optional<FrameInput> input_;
  ros::WallTimer publish_timer_, autosave_timer_;
  std::optional<hyselam::Diagnostics> diagnostics_;
};

}  // namespace hyselam_objects

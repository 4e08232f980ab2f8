// Tests the pose of the localization by the recognized place, and starts the localization again
// where they disagree.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <hyselam_msgs/LocalizationStatus.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "selovis/places/topological_places.hpp"
#include "selovis/ros/camera_poses.hpp"
#include "selovis/ros/parameters.hpp"
#include "selovis/ros/sensor_history.hpp"

namespace selovis {

/// Topics: in `localization_status`, and with SupervisionParams::use_scan `scan` and `map`; out
/// `~kidnapped` (std_msgs/Bool, latched), `initialpose`. Calls the service `global_localization`.
/// All callbacks on the queue of `nh`.
class PoseSupervision {
 public:
  /// @param poses is kept as a reference.
  PoseSupervision(ros::NodeHandle nh, ros::NodeHandle private_nh, const SupervisionParams& params,
                  const CameraPoses& poses, std::string log_name);

  /// From now on scans and maps are received: a nodelet's queue is served while its constructor
  /// still runs, so this comes last.
  void subscribe();
  /// Another model, other places, or other transitions between them: all evidence is forgotten.
  /// `same_samples`: as those of the model before, so that what the camera was found to err in is
  /// kept.
  void setModel(const PlaceModel& model, const PlaceTransitions& transitions,
                bool same_samples = false);
  /// The frame that the recognizer saw last. @param image its header.
  void update(const ImageRecognizer& recognizer, const hyselam_topo::AugmentedTopologicalMap& map,
              const std_msgs::Header& image);

  bool kidnapped() const { return state_.kidnapped; }
  /// Where the camera was found to err with the present model; null: nothing is known.
  const ReliabilityMemory* memory() const { return supervisor_ ? supervisor_->memory() : nullptr; }
  void report(diagnostic_msgs::DiagnosticStatus& status) const;

 private:
  /// Why the localization has to begin again.
  enum class Cause { kNone, kCamera, kLocalization };
  struct Counts {
    std::size_t tested = 0, by_views = 0, scans = 0, alarms = 0, lost = 0, poses_set = 0,
                searches = 0;
  };

  /// Takes up, and drops, what the localization reports of being lost.
  void followLocalizationStatus(const ros::Time& stamp);
  /// Whether the localization vouches for its pose, as far as it is known.
  bool poseIsValid(const ros::Time& stamp);
  void onMap(const nav_msgs::OccupancyGrid& msg);
  /// The scan nearest to an image; null where none came within a tenth of a second.
  const ScanPoints* scanAt(const ros::Time& stamp);
  void raiseAlarm(const ros::Time& stamp);
  /// Starts the localization again, in the place once it is known.
  void relocalize(const hyselam_topo::AugmentedTopologicalMap& map, const ros::Time& stamp);
  void publishInitialPose(const PlacePosePrior& prior, const std::string& frame_id,
                          const ros::Time& stamp);
  /// In a thread of its own: the service may take its time. One search at a time.
  void startGlobalLocalization();
  void reportGlobalLocalization();
  void publishKidnapped();
  const std::string& placeName() const;

  const SupervisionParams params_;
  const CameraPoses& poses_;
  const std::string log_name_;
  PlaceTransitions transitions_;
  std::unique_ptr<PoseSupervisor> supervisor_;  // null without places
  std::shared_ptr<const ScanFit> fit_;          // null without a map
  SensorHistory<sensor_msgs::LaserScan> scans_;
  ScanPoints points_;
  std::string scan_problem_;
  std::optional<ros::Time> last_frame_;
  SupervisionState state_;
  std::optional<bool> published_;
  hyselam_msgs::LocalizationStatus::ConstPtr status_;
  Cause pending_ = Cause::kNone;  // the localization has not been started again yet
  ros::Time pending_since_;
  std::optional<ros::Time> set_at_;  // when the pose was set
  ExpectedPlaces expected_;          // at the pose
  Counts counts_;
  std::string last_alarm_;
  ros::NodeHandle nh_;
  ros::Publisher kidnapped_publisher_, initialpose_publisher_;
  ros::ServiceClient global_localization_;
  ros::Subscriber status_subscriber_, scan_subscriber_, map_subscriber_;
  std::future<bool> search_;
};

}  // namespace selovis

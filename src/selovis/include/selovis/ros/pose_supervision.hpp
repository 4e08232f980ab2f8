// The place seen against the pose of the localisation, and what is done when they disagree.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <hyselam_msgs/LocalizationStatus.h>
#include <ros/ros.h>

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "selovis/ros/parameters.hpp"
#include "selovis/topology.hpp"

namespace selovis {

/// Topics: in `localization_status`; out `~kidnapped` (std_msgs/Bool, latched), `initialpose`.
/// Calls the service `global_localization`. All callbacks on the queue of `nh`.
class PoseSupervision {
 public:
  PoseSupervision(ros::NodeHandle nh, ros::NodeHandle private_nh,
                  const SemanticLocalizationParams& params, std::string who);

  /// Other places, or other doors between them: all evidence is forgotten.
  void setGraph(const PlaceGraph& graph);
  /// One frame. `pose`: of the robot in the map, if known. `frame`: probabilities by this frame
  /// alone.
  void judge(const std::vector<double>& frame, const std::optional<hyselam::Pose2>& pose,
             const hyselam_topo::AugmentedTopologicalMap& map, const ros::Time& stamp);

  bool kidnapped() const { return last_.kidnapped; }
  void report(diagnostic_msgs::DiagnosticStatus& status) const;

 private:
  /// A localisation that says that it is lost is told the place, once that is known.
  void heedLost(const ros::Time& stamp);
  /// Whether the localisation believes in its pose, as far as it is known.
  bool poseIsMeant(const ros::Time& stamp);
  void act(const hyselam_topo::AugmentedTopologicalMap& map, const ros::Time& stamp);
  /// In a thread of its own: the service may take its time. One search at a time.
  void searchEverywhere();
  void tellSearch();
  void publishKidnapped();

  SemanticLocalizationParams params_;
  std::string who_;
  PlaceGraph graph_;
  std::unique_ptr<Supervisor> supervisor_;
  Supervision last_;
  std::optional<bool> published_;
  hyselam_msgs::LocalizationStatus::ConstPtr status_;
  bool to_act_ = false;    // an alarm waits for the place to be known
  bool by_laser_ = false;  // it is the localisation's own
  ros::Time alarm_at_;
  std::optional<ros::Time> set_at_;  // when the pose was set anew
  ExpectedPlaces expected_;          // at the pose
  std::size_t judged_ = 0, alarms_ = 0, poses_set_ = 0, searches_ = 0, lost_ = 0;
  std::string last_alarm_;
  ros::Publisher kidnapped_publisher_, initialpose_publisher_;
  ros::ServiceClient global_localization_;
  ros::Subscriber status_subscriber_;
  std::future<bool> search_;
};

}  // namespace selovis

// ROS interface of Gr2To: a live grid map or OctoMap in, a topological map (places, doors, walls)
// out.
#pragma once

#include <hyselam_msgs/PlaceAt.h>
#include <hyselam_msgs/TopologicalMapPath.h>
#include <nav_msgs/OccupancyGrid.h>
#include <octomap_msgs/Octomap.h>
#include <ros/ros.h>

#include <mutex>
#include <optional>
#include <string>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_gr2to/background_gr2to.hpp"
#include "hyselam_topo/ros/gr2to_parameters.hpp"

namespace hyselam_topo {

/// Topics, services and parameters: see README.md. Callbacks run on the queue of `nh`, one at a
/// time, and never wait for a segmentation, which has a thread of its own.
class Gr2ToServer {
 public:
  /// Reads and checks the parameters of `private_nh`, before anything is subscribed.
  /// Without a pipeline it is BackgroundGr2To::updating() with the parameter `partial_updates`.
  /// @throws hyselam::ParameterError; hyselam::InputError for `map_file`.
  Gr2ToServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh,
              BackgroundGr2To::Pipeline pipeline = nullptr);
  ~Gr2ToServer();

  const Gr2ToServerParams& params() const { return params_; }
  /// Other parameters from now on: the last input is segmented again.
  /// `use_octomap`, `map_file`, `max_map_cells`, `partial_updates` and `diagnostic_period` stay as
  /// they are.
  void setParams(const Gr2ToServerParams& params);

 private:
  void onMap(const nav_msgs::OccupancyGrid::ConstPtr& msg);
  void onOctomap(const octomap_msgs::Octomap::ConstPtr& msg);
  void startLast();
  /// In the thread of the segmentation.
  void onOutcome(const BackgroundGr2To::Outcome& outcome);
  void publish(const BackgroundGr2To::MapPtr& map);
  void logOutcome(const BackgroundGr2To::Outcome& outcome,
                  const AugmentedTopologicalMap* before) const;

  bool onPlaceAt(hyselam_msgs::PlaceAt::Request& request,
                 hyselam_msgs::PlaceAt::Response& response);
  bool onSave(hyselam_msgs::TopologicalMapPath::Request& request,
              hyselam_msgs::TopologicalMapPath::Response& response);
  bool onLoad(hyselam_msgs::TopologicalMapPath::Request& request,
              hyselam_msgs::TopologicalMapPath::Response& response);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string who_;
  Gr2ToServerParams params_;
  int params_version_ = 0;
  /// The last input, to be used again with other parameters.
  nav_msgs::OccupancyGrid::ConstPtr last_map_;
  octomap_msgs::Octomap::ConstPtr last_octomap_;
  std::size_t received_ = 0;
  ros::WallTime begun_ = ros::WallTime::now();

  struct Status {
    std::size_t segmented = 0, unchanged = 0, refused = 0;
    std::string error;  ///< of the last input; empty: it was used
    std::size_t places = 0, doors = 0;
    double seconds = 0.0;
    std::vector<std::pair<std::string, double>> stages;
  };
  mutable std::mutex mutex_;  // guards what follows and the order of publication
  Status status_;
  BackgroundGr2To::MapPtr published_;
  MapMarkerParams marker_params_;

  ros::Publisher map_publisher_, marker_publisher_, projected_publisher_;
  ros::Subscriber subscriber_;
  ros::ServiceServer place_at_service_, save_service_, load_service_;
  std::optional<hyselam::Diagnostics> diagnostics_;
  BackgroundGr2To background_;  // last: its thread ends before what it uses
};

}  // namespace hyselam_topo

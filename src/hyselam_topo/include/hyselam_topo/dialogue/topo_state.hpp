// TopoState (dos Santos, section 3.2.2): the robot's place in the topological map from its pose in
// the grid map, without flickering at doors.
#pragma once

#include "hyselam_common/parameters.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct TopoStateParams {
  /// Within this of a door the robot is in the doorway, where its place stays what it was. [m] >= 0
  double doorway_distance = 0.4;
  /// A pose on no place counts to the nearest place within this. [m] >= 0
  double max_place_distance = 0.3;
  /// In a place that is too narrow to be well inside it is accepted after this time. [s] >= 0
  double settle_time = 3.0;
  /// A pose that moves by more than this at once is a new one: no doorway holds it. [m] > 0
  double max_pose_step = 1.0;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a parameter out of range.
  void validate() const;
};

struct RobotPlace {
  double stamp = 0.0;  ///< of the pose [s]
  bool has_pose = false;
  hyselam::Pose2 pose;      ///< in the frame of the map
  Id place = 0;             ///< 0: not known
  Id previous = 0;          ///< the place before this one; 0: none
  bool in_doorway = false;  ///< `place` is held until the robot is well inside the next
};

class TopoState {
 public:
  /// @throws hyselam::ParameterError for a parameter out of range.
  explicit TopoState(const TopoStateParams& params = {});

  /// The pose at a time, in the frame of the map. True if place, previous or in_doorway changed.
  /// A pose that is not finite is none: lost().
  bool update(const AugmentedTopologicalMap& map, double stamp, const hyselam::Pose2& pose);
  /// There is no pose: the place is not known. True if it was.
  bool lost(double stamp);
  /// After another map: a place that is not in it any more is not known.
  bool mapChanged(const AugmentedTopologicalMap& map);

  const RobotPlace& robot() const { return robot_; }

 private:
  bool set(Id place, bool in_doorway);

  TopoStateParams params_;
  RobotPlace robot_;
  Id candidate_ = 0;              // a place that the robot may be entering ...
  double candidate_since_ = 0.0;  // ... and since when
};

}  // namespace hyselam_topo

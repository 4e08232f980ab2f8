// TopoState (dos Santos, section 3.2.2): the robot's place in the topological map from its pose in
// the grid map, without flickering at doors.
#pragma once

#include "hyselam_common/parameters.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct TopoStateParams {
  /// Nearer than this to a door the robot is in the doorway and its place does not change. [m] >= 0
  double doorway_distance = 0.4;
  /// A pose on no place counts to the nearest place within this. [m] >= 0
  double max_place_distance = 0.3;
  /// After this time in the next place, the place changes in a doorway, too. [s] >= 0
  double settle_time = 3.0;
  /// A pose that jumps by more than this is a relocalization: the place is updated even in a
  /// doorway. [m] > 0
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
  bool in_doorway = false;  ///< near a door, where `place` does not change yet
};

class TopoState {
 public:
  /// @throws hyselam::ParameterError for a parameter out of range.
  explicit TopoState(const TopoStateParams& params = {});

  /// The pose at a time, in the frame of the map. True if place, previous or in_doorway changed.
  /// A pose that is not finite has the effect of lost().
  bool update(const AugmentedTopologicalMap& map, double stamp, const hyselam::Pose2& pose);
  /// The pose is lost: the place becomes unknown. True if it was known.
  bool lost(double stamp);
  /// The map was replaced: a place that is not in it any more becomes unknown.
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

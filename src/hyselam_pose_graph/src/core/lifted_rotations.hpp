// Initial poses for graphs whose rotations are too noisy for the chordal relaxation.
#pragma once

#include <memory>
#include <vector>

#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// Rotations by the Burer-Monteiro form of the semidefinite relaxation (Rosen et al., SE-Sync
/// 2019): each pose's rotation is a unit vector of C^2 instead of C, each position another vector,
/// a larger space with fewer local minima; the dominant direction of the result gives the
/// rotations. Deterministic.
class LiftedRotations {
 public:
  /// Starts at `poses`; the system has to stay.
  LiftedRotations(const PoseSystem& system, std::vector<SystemPose> poses);
  ~LiftedRotations();
  /// Goes on until a step gains less than this part of the cost, or that many steps were made in
  /// all. @returns false, and nothing is done, if the edges do not determine all poses
  [[nodiscard]] bool descend(double tolerance, int max_iterations = 300);
  /// Those of the start with the rotations of where it is now.
  std::vector<SystemPose> poses() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hyselam_pose_graph

// A start for graphs whose rotations are so noisy that the chordal relaxation misleads.
#pragma once

#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// Rotations by the Burer-Monteiro form of the semidefinite relaxation (Rosen et al., SE-Sync
/// 2019): each pose's rotation is a unit vector of C^2 instead of C, each position another vector,
/// in which more room has fewer false minima; the result's main direction gives the rotations.
/// Starts at `poses` and returns them with other rotations and positions; deterministic.
std::vector<SystemPose> liftedSolution(const PoseSystem& system, std::vector<SystemPose> poses,
                                       int max_iterations = 300);

}  // namespace hyselam_pose_graph

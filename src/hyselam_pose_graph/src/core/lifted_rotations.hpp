// Initial poses for graphs whose rotations are too noisy for the chordal relaxation.
#pragma once

#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// Rotations by the Burer-Monteiro form of the semidefinite relaxation (Rosen et al., SE-Sync
/// 2019): each pose's rotation is a unit vector of C^2 instead of C, each position another vector,
/// a larger space with fewer local minima; the dominant direction of the result gives the
/// rotations. Starts at `poses` and returns them with other rotations and positions; deterministic.
std::vector<SystemPose> solveLifted(const PoseSystem& system, std::vector<SystemPose> poses,
                                    int max_iterations = 300);

}  // namespace hyselam_pose_graph

// Whether so much motion was seen while the odometry stood still that it is to be told.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "ngram_slam/slam/odometry_doubt.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Motion of `road` that the odometry did not tell, against all motion of the keyframes from
/// `first` on. On good recordings it is some centimeters now and then: 0.4 % of the path and 0.8 %
/// of the rotation of intel, 0.9 and 1.7 % of aces; wheels that stand in the odometry for 5 s of
/// 100 s make it about 5 %. The limit was chosen on these.
inline bool odometryStands(const RoughRoad& road, const std::vector<SlamKeyframe>& keyframes,
                           std::size_t first) {
  constexpr double kLeastPath = 1.0, kLeastTurn = 0.5;  // [m], [rad]
  constexpr double kPart = 0.03;
  double path = 0.0, turn = 0.0;
  for (std::size_t k = first + 1; k < keyframes.size(); ++k) {
    if (keyframes[k].run != keyframes[k - 1].run) continue;
    const hyselam::Pose2 step = between(keyframes[k - 1].pose, keyframes[k].pose);
    path += std::hypot(step.x, step.y);
    turn += std::abs(step.theta);
  }
  return road.path_unseen > std::max(kLeastPath, kPart * path) ||
         road.turn_unseen > std::max(kLeastTurn, kPart * turn);
}

}  // namespace ngram_slam

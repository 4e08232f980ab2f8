// The scans of a path around a keyframe, to verify loops with.
#pragma once

#include <vector>

#include "ngram_slam/slam/loop_verifier.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// The scans of the run of keyframe `k` up to `half_length` [m] of path before and after it, none
/// beyond `max_path_length`, in the frame of `k`.
LoopTask::Segment segmentAround(const std::vector<SlamKeyframe>& keyframes, int k,
                                double half_length, double max_path_length);

}  // namespace ngram_slam

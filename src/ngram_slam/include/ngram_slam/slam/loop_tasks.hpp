// What the scans are asked: whether two keyframes show the same place.
#pragma once

#include <vector>

#include "ngram_slam/slam/loop_verifier.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// The task to verify that two keyframes show the same place, at any heading; its source
/// is kSignature unless it is told otherwise.
LoopTask farLoopTask(const std::vector<SlamKeyframe>& keyframes, int older, int newer,
                     const LoopParams& params);

/// The task to verify that the scan of a keyframe is where the poses say beside the path of another
/// one, within `uncertainty` [m].
LoopTask nearLoopTask(const std::vector<SlamKeyframe>& keyframes, int older, int newer,
                      double uncertainty, const LoopParams& params);

/// The task to ask the path before keyframe `k` and the path behind it for the step between the
/// keyframe before it, which is of the same run, and itself.
LoopTask stepTask(const std::vector<SlamKeyframe>& keyframes, int k, const StepCheckParams& params);

}  // namespace ngram_slam

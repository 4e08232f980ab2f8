// Verifies by the scans alone whether two path segments show the same place.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ngram_slam/slam/observed_space.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// A loop to verify, with all data needed: does not access the engine.
struct LoopTask {
  struct PosedScan {
    hyselam::Pose2 pose;                                                 ///< of the base
    std::shared_ptr<const hyselam_scan_matching::SurfacePoints> points;  ///< in the base frame
    hyselam::Point2 laser;                                               ///< in the base frame
  };
  using Segment = std::vector<PosedScan>;

  int older = 0, newer = 0;  ///< keyframes
  LoopSource source = LoopSource::kProximity;
  bool far = false;              ///< see LoopParams
  bool step = false;             ///< `newer` follows `older`: see StepCheckParams
  std::int64_t match = -1;       ///< of SlamState::matches, for LoopSource::kNgram
  hyselam::Pose2 initial_guess;  ///< newer in older
  double window = 1.0;           ///< search window around it, +- along each axis [m]
  double angle = 0.3;            ///< search window of headings, +- [rad]
  /// The heading of the guess is not known: those are searched at which what is around both
  /// segments fits best, the second where the first is refused.
  bool any_heading = false;
  /// That the guess is right, by a search of all other maps (KnownMaps); 0: none was made.
  double place_probability = 0.0;
  Segment old_segment;  ///< in the frame of `older`
  Segment new_segment;  ///< in the frame of `newer`; one scan when near
};

struct LoopVerification {
  bool verified = false;
  SlamLoop loop;
  double score = 0.0;  ///< of the search, 0..1
  Overlap new_in_old, old_in_new;
  /// Score of the best pose elsewhere if that makes the loop ambiguous; else 0.
  double ambiguous_score = 0.0;
};

/// Searches the window for the pose at which the new segment lies on the surfaces of the old one,
/// refines it, and judges it by inliers and by what both segments observed. `information` is scaled
/// by `scan_information_scale` as odometry's is.
LoopVerification verifyLoop(const LoopTask& task, const SlamParams& params);
/// The same of a step of the path, by StepCheckParams: both parts have only some of their
/// surroundings in common.
LoopVerification verifyStep(const LoopTask& task, const SlamParams& params);

}  // namespace ngram_slam

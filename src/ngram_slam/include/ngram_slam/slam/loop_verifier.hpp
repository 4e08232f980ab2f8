// Whether two stretches of the way are the same place: by the scans alone.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ngram_slam/slam/seen_space.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// A question that can be answered without the engine, on any thread.
struct LoopTask {
  struct Seen {
    hyselam::Pose2 pose;                                                 ///< of the base
    std::shared_ptr<const hyselam_scan_matching::SurfacePoints> points;  ///< in the base frame
    hyselam::Point2 laser;                                               ///< in the base frame
  };
  using Stretch = std::vector<Seen>;

  int older = 0, newer = 0;  ///< keyframes
  LoopSource source = LoopSource::kProximity;
  bool far = false;
  std::int64_t match = -1;  ///< of SlamState::matches, for LoopSource::kNgram
  hyselam::Pose2 guess;     ///< newer in older
  double window = 1.0;      ///< [m]
  double turn = 0.3;        ///< [rad]
  Stretch old_stretch;      ///< in the frame of `older`
  Stretch new_stretch;      ///< in the frame of `newer`; one scan when near
};

struct LoopAnswer {
  bool verified = false;
  SlamLoop loop;
  double score = 0.0;  ///< of the search, 0..1
  Overlap new_in_old, old_in_new;
  double rival = 0.0;  ///< of the best pose elsewhere, 0 if not asked or below all bounds
};

/// Searches the window for the pose at which the new stretch lies on the surfaces of the old one,
/// refines it, and judges it. `information` is scaled by `scan_information` as odometry's is.
LoopAnswer verifyLoop(const LoopTask& task, const SlamParams& params);

}  // namespace ngram_slam

// Converts density measurements, one per scan, to observations at equal steps of the path.
#pragma once

#include <optional>
#include <vector>

#include "ngram_slam/words/density_observation.hpp"

namespace ngram_slam {

/// Whether the odometry jumped between two observations: they are not connected by a path, and the
/// second one belongs to a new run.
inline bool odometryJumped(const DensityObservation& before, const DensityObservation& now) {
  return hyselam::distance(before.base_in_odom, now.base_in_odom) > DistanceSampler::kMaxGap;
}

class ObservationSampler {
 public:
  /// @throws hyselam::ParameterError unless step > 0.
  explicit ObservationSampler(double step) : sampler_(step) {}

  /// Where observations are due on the path to `pose`; see DistanceSampler. To be followed by
  /// sampleAt() if there are any.
  std::vector<hyselam::Pose2> due(const hyselam::Pose2& pose) { return sampler_.due(pose); }
  /// What is observed there: of several, the earlier ones lie between the last observation and
  /// `now`, in time and soft density alike; they have no hard density.
  std::vector<DensityObservation> sampleAt(const DensityObservation& now,
                                           const std::vector<hyselam::Pose2>& due);
  /// Whether the odometry jumped to this pose, so that there is no path from the last observation.
  bool isJump(const hyselam::Pose2& pose) const {
    return last_ && hyselam::distance(last_->base_in_odom, pose) > DistanceSampler::kMaxGap;
  }
  /// Restarts sampling: the next measurement is treated as the first one.
  void reset() {
    sampler_.reset();
    last_.reset();
  }

 private:
  DistanceSampler sampler_;
  std::optional<DensityObservation> last_;
};

}  // namespace ngram_slam

#include "ngram_slam/words/observation_sampler.hpp"

namespace ngram_slam {

std::vector<DensityObservation> ObservationSampler::sampleAt(
    const DensityObservation& now, const std::vector<hyselam::Pose2>& due) {
  std::vector<DensityObservation> out;
  const bool jump = isJump(now.base_in_odom);
  const DensityObservation before = last_.value_or(now);
  const double path = hyselam::distance(before.base_in_odom, now.base_in_odom);
  for (const hyselam::Pose2& pose : due) {
    DensityObservation o = now;
    if (due.size() > 1 && path > 0.0 && !jump) {
      const double share = hyselam::distance(before.base_in_odom, pose) / path;
      o.stamp = before.stamp + share * (now.stamp - before.stamp);
      o.soft = before.soft + share * (now.soft - before.soft);
      o.hard.reset();
    }
    o.base_in_odom = pose;
    out.push_back(o);
  }
  if (!out.empty()) last_ = out.back();
  return out;
}

}  // namespace ngram_slam

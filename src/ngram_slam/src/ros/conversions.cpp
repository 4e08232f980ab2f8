#include "ngram_slam/ros/conversions.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace ngram_slam {

using hyselam::InputError;

DensityObservation fromMsg(const hyselam_msgs::FsdObservation& msg, double bandwidth,
                           const std::string& source) {
  const std::size_t kernels = msg.kernel_names.size();
  if (msg.bandwidths.size() != kernels || msg.soft.size() != kernels ||
      msg.hard.size() != kernels || msg.frontiers.size() != kernels)
    throw InputError(source, "arrays", "have unequal lengths");
  std::size_t k = 0;
  while (k < kernels && !(msg.kernel_names[k] == "uniform" &&
                          std::abs(static_cast<double>(msg.bandwidths[k]) - bandwidth) < 1e-4))
    ++k;
  if (k == kernels)
    throw InputError(source, "kernels",
                     "hold no uniform kernel of " + std::to_string(bandwidth) + " m");
  DensityObservation o;
  o.stamp = hyselam::toSeconds(msg.header.stamp);
  o.base_in_odom = {msg.base_in_odom.x, msg.base_in_odom.y, msg.base_in_odom.theta};
  if (!o.base_in_odom.isFinite()) throw InputError(source, "base_in_odom", "is not finite");
  o.base_in_odom.theta = hyselam::normalizeAngle(o.base_in_odom.theta);
  const auto density = [&](float value, const char* name) {
    const double d = value;
    // Sums of a kernel's weights may exceed 1 by their rounding.
    if (!(d >= 0.0 && d <= 1.001))
      throw InputError(source, name, "is " + std::to_string(d) + ", not in 0..1");
    return std::min(d, 1.0);
  };
  o.soft = density(msg.soft[k], "soft density");
  if (!std::isnan(msg.hard[k])) o.hard = density(msg.hard[k], "hard density");
  o.frontiers = std::clamp(msg.frontiers[k], 0, 255);
  return o;
}

hyselam_msgs::Word wordMsg(const NgramRecognizer& recognizer, WordIndex index) {
  const ObservationStore& observations = recognizer.observations();
  const WordLattice& text = recognizer.text();
  const DensityWord w = text.word(index);
  hyselam_msgs::Word msg;
  msg.index = index;
  msg.level = static_cast<std::uint8_t>(w.level);
  msg.first = w.first;
  msg.last = w.last;
  msg.density_class = static_cast<std::uint8_t>(w.syllables.density_class);
  msg.size = w.syllables.size;
  msg.angle = w.syllables.angle;
  msg.observation_begin = text.observationBegin(index);
  msg.observation_end = text.observationEnd(index);
  const std::uint32_t begin = msg.observation_begin, last = msg.observation_end - 1;
  msg.run = observations.runOf(begin);
  msg.stamp_begin = hyselam::toRosTime(observations.stamp(begin));
  msg.stamp_end = hyselam::toRosTime(observations.stamp(last));
  msg.begin_in_odom = hyselam::toPose2dMsg(observations.pose(begin));
  msg.end_in_odom = hyselam::toPose2dMsg(observations.pose(last));
  return msg;
}

hyselam_msgs::WordMatch matchMsg(const NgramRecognizer& recognizer, const NgramMatch& match,
                                 const ObservationPair& place) {
  const ObservationStore& observations = recognizer.observations();
  hyselam_msgs::WordMatch msg;
  msg.newer = match.newer;
  msg.older = match.older;
  msg.level = static_cast<std::uint8_t>(match.levels - 1);
  msg.n = static_cast<std::uint16_t>(match.n);
  msg.direction = match.direction == Direction::kReverse ? hyselam_msgs::WordMatch::REVERSE
                                                         : hyselam_msgs::WordMatch::SAME;
  msg.chance = match.chance;
  msg.probability = match.probability;
  msg.stamp_newer = hyselam::toRosTime(observations.stamp(place.newer));
  msg.stamp_older = hyselam::toRosTime(observations.stamp(place.older));
  msg.run_newer = observations.runOf(place.newer);
  msg.run_older = observations.runOf(place.older);
  msg.newer_in_odom = hyselam::toPose2dMsg(observations.pose(place.newer));
  msg.older_in_odom = hyselam::toPose2dMsg(observations.pose(place.older));
  msg.alignment_rms = static_cast<float>(place.rms);
  return msg;
}

hyselam_msgs::SemanticRegion regionMsg(const ObservationStore& observations,
                                       const SemanticRegion& region, double step) {
  hyselam_msgs::SemanticRegion msg;
  msg.semantic_class = static_cast<std::uint8_t>(indexOf(region.semantic_class));
  msg.class_name = toString(region.semantic_class);
  msg.confidence = static_cast<float>(region.confidence);
  msg.run = observations.runOf(region.first);
  msg.first = region.first;
  msg.last = region.last;
  msg.stamp_begin = hyselam::toRosTime(observations.stamp(region.first));
  msg.stamp_end = hyselam::toRosTime(observations.stamp(region.last));
  msg.begin_in_odom = hyselam::toPose2dMsg(observations.pose(region.first));
  msg.end_in_odom = hyselam::toPose2dMsg(observations.pose(region.last));
  msg.length = static_cast<float>(step * (region.last - region.first + 1));
  return msg;
}

}  // namespace ngram_slam

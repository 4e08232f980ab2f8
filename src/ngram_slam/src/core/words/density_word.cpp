#include "ngram_slam/words/density_word.hpp"

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::Pose2;

double angleVariation(const Pose2& first, const Pose2& median, const Pose2& last,
                      double min_displacement) {
  const auto direction = [&](const Pose2& from, const Pose2& to, double otherwise) {
    return hyselam::distance(from, to) < min_displacement
               ? otherwise
               : std::atan2(to.y - from.y, to.x - from.x);
  };
  return hyselam::normalizeAngle(direction(median, last, last.theta) -
                                 direction(first, median, first.theta));
}

double angleVariation(const ObservationStore& observations, std::uint32_t begin,
                      std::uint32_t end) {
  return angleVariation(observations.pose(begin), observations.pose(begin + (end - 1 - begin) / 2),
                        observations.pose(end - 1));
}

void WordTolerance::validate() const {
  if (!(size > 0.0 && size < 1.0))
    throw hyselam::ParameterError("size tolerance", size, "in (0, 1)");
  if (!(angle > 0.0 && angle < hyselam::kPi))
    throw hyselam::ParameterError("angle tolerance", angle, "in (0, pi) [rad]");
}

}  // namespace ngram_slam

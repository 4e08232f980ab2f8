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

void WordTolerance::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("size_tolerance", size, Range::inside(0.0, 1.0), "",
        "epsilon_s: by how much of the larger one the sizes of matching words differ, at most");
  visit("angle_tolerance", angle, Range::inside(0.0, hyselam::kPi), "rad",
        "epsilon_a: difference of the angles of matching words at most");
}

void WordTolerance::validate() const {
  hyselam::checkParameters(*this);
}

}  // namespace ngram_slam

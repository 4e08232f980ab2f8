// Decides whether a pose hypothesis still fits, by moving averages of the inlier ratio: the share
// of returns that end at mapped obstacles.
#pragma once

#include <optional>

namespace fsd_localization {

/// Moving averages of an inlier ratio over the motion of the robot: a fast one, by which a place is
/// judged, and a slow one, which shows what is normal at this place (people and furniture that are
/// not on the map); and one over the last steps, in which a single odd scan does not show.
class InlierMonitor {
 public:
  /// Clears the averages: another pose hypothesis is judged from now on.
  void reset();
  /// What was seen over the last metre is normal here.
  void accept();
  /// @param inlier_ratio 0..1; empty: the scan had no return. @param motion since the last one [m].
  void add(const std::optional<double>& inlier_ratio, double motion);

  /// The fast average; 0 before the first ratio.
  double average() const { return fast_.value_or(0.0); }
  /// What is normal here: the slow average; 0 before the first ratio.
  double usual() const { return slow_.value_or(0.0); }
  /// Whether the scans of the last steps (an average over about 0.3 m) fit at least `min_relative`
  /// times as well as is normal here. It takes two scans to be unusual, however far apart they are.
  bool isUsual(double min_relative) const;
  /// Whether the last scan alone fits less than `min_relative` times as well as is normal here.
  bool isOdd(double min_relative) const;
  /// Whether the last scan had returns, the robot has moved enough to judge, and the fast average
  /// and the last two scans lie below `min_ratio`, or below `min_relative` times the slow average.
  bool isBelow(double min_ratio, double min_relative) const;

 private:
  bool current_ = false;  // the last scan had returns
  double motion_ = 0.0;   // [m] since reset()
  std::optional<double> last_, fast_, slow_;
  double better_of_two_ = 1.0;  // of the last two scans
  double newest_ = 1.0;
};

}  // namespace fsd_localization

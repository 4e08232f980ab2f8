// Whether a tracked pose explains the last metres worse than usual.
#pragma once

#include <optional>

namespace fsd_localization {

/// Now and then the score of the pose is compared with its average over about 30 m. In a corridor
/// that looks alike everywhere nothing else tells that the robot was carried along it. Way: see
/// way.hpp.
class ScoreWatch {
 public:
  static constexpr double kStep = 1.0;    ///< [m] between looks at the score
  static constexpr double kWorse = 0.08;  ///< [of the score] below the usual one

  /// Whether it is time for another look.
  bool isDue(double way) const { return way - looked_at_ >= kStep; }
  /// @param score Place::seen of the pose, by the scans of the last metres.
  void look(double way, double score);
  /// Whether the last look found it worse; no before the first one.
  bool isWorse() const { return worse_; }
  /// Another pose is tracked, or what is seen now is normal here: the next look tells what is
  /// usual.
  void reset();

 private:
  std::optional<double> usual_;
  double looked_at_ = 0.0;  // [m]
  bool worse_ = false;
};

}  // namespace fsd_localization

// Whether a standing robot sees something else than it should: it was perhaps carried off.
#pragma once

#include <optional>

namespace fsd_localization {

/// A robot that stands gets no updates, and averages over its motion tell nothing. So the scans of
/// one that stands are judged over time: what people hide who pass by comes and goes.
class StandingWatch {
 public:
  static constexpr double kSeconds = 5.0;  ///< [s] that scans must say the same without exception
  static constexpr int kScans = 5;         ///< and so many scans

  /// The robot has moved: what was seen before says nothing any more.
  void reset() { *this = StandingWatch(); }
  /// A scan of a robot that stands. @param stamp of it [s]. @param inlier_ratio 0..1; empty: the
  /// scan had no return, and says nothing. @param low below it the scan does not fit the map.
  /// @param fits from it on the scan fits; >= low.
  /// @returns whether isLow() has changed.
  bool add(double stamp, const std::optional<double>& inlier_ratio, double low, double fits);
  /// Whether the scans have not fitted the map for long, and not fitted it for long again since.
  bool isLow() const { return low_; }

 private:
  bool low_ = false;
  std::optional<double> since_;  // [s] when the scans began to say the opposite
  int scans_ = 0;                // that said so
};

}  // namespace fsd_localization

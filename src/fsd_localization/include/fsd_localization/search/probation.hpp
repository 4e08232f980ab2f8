// A place that was found a moment ago, and that no search has confirmed since.
#pragma once

#include <optional>

namespace fsd_localization {

/// One answer of a search found the place, by the scans of a metre perhaps. Until an answer that
/// also rests on scans of after that is as sure, the pose is asked about each metre, and while
/// other places together are likelier it is not to be relied on. It is not given up for that: the
/// map may know the room in part only, and then it is asked about each metre for as long. Way:
/// see way.hpp.
class Probation {
 public:
  static constexpr double kOwnScans = 1.5;  ///< [m] seen since it was found, that confirm a place
  static constexpr double kStep = 1.0;      ///< [m] between questions

  /// A place was found.
  void begin(double way) { *this = Probation(way); }
  void reset() { from_.reset(), doubtful_ = false; }
  /// An answer about the pose. @param way when it was asked. @param probability of the pose.
  /// @param sure from which on a place is believed. Says nothing if no place is on probation.
  void answered(double way, double probability, double sure);

  bool isOpen() const { return from_.has_value(); }
  /// Whether the last answer found other places together likelier.
  bool isDoubtful() const { return doubtful_; }

  Probation() = default;

 private:
  explicit Probation(double way) : from_(way) {}

  std::optional<double> from_;
  bool doubtful_ = false;
};

}  // namespace fsd_localization

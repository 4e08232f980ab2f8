// When a tracked pose is to be asked about, and whether it may be told as sure meanwhile.
#pragma once

#include <optional>

namespace fsd_localization {

/// An alarm begins with something that speaks against the pose and ends when a search of the map
/// has confirmed the pose and nothing speaks against it any more; it never ends by itself. Way:
/// see way.hpp.
class AlarmWatch {
 public:
  static constexpr double kFirstStep = 0.5;            ///< [m] between questions
  static constexpr double kLargestStep = 16.0;         ///< [m] at most
  static constexpr double kLargestDoubtfulStep = 4.0;  ///< [m] at most about a doubtful pose
  /// What the last scans say.
  struct Signs {
    bool broken = false;     ///< the motion between two scans is unknown
    bool unmatched = false;  ///< a scan fits what was seen last far worse than usual
    bool odd = false;        ///< the last scan fits the map worse than usual
    bool unusual = false;    ///< the last scans fit the map worse than usual
    bool low = false;        ///< so they did over the last metre
    bool worse = false;      ///< the pose explains the last metres a little worse than usual
    bool very_low = false;   ///< hardly anything fits the map
  };
  /// @returns whether the alarm is a new one: what was asked before says nothing about it.
  bool add(double way, const Signs& signs);
  /// A search found no better place, with what was seen since the alarm began.
  void confirm();
  /// An answer of a search that does not make the robot lost. The way to the next question doubles;
  /// not if the answer spoke against the pose, by too few scans to count.
  void answered(bool is_against);
  void reset() { *this = AlarmWatch(); }

  bool isOpen() const { return from_.has_value(); }
  bool isConfirmed() const { return confirmed_; }
  /// Whether the pose is not to be relied on: the scans fit neither each other nor the map, or
  /// hardly anything fits the map, and no search has confirmed the pose since.
  bool isDoubtful() const { return doubtful_; }
  /// Whether the scans have fitted neither each other nor the map since the alarm began: the robot
  /// was perhaps carried off.
  bool looksCarried() const { return carried_; }
  /// Whether it is known where the alarm began: scans did not fit the map from there on.
  bool isSharp() const { return sharp_; }
  /// Way since the alarm began; nothing if there is none.
  std::optional<double> length(double way) const;
  /// [m] of way between two questions about the alarm.
  double step() const { return step_; }

 private:
  double step_ = kFirstStep;        // [m] to the next question
  std::optional<double> from_;      // [m] way at which the alarm began
  double unmatched_at_ = -1.0;      // [m] when scans did not fit each other last
  double suspicious_until_ = -1.0;  // [m] so long the last scans fit each other badly
  double strange_until_ = -1.0;     // [m] so long what is strange is the same alarm
  bool confirmed_ = false, doubtful_ = false, carried_ = false, sharp_ = false;
};

}  // namespace fsd_localization

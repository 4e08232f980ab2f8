// Detection of a kidnapped robot or a diverged localization: compares the place recognized in the
// camera images with the place at the estimated pose (dos Santos 2014, chapter 6).
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {

struct KidnappingDetectorParams {
  /// Frames that are nearer in time than this are not independent [s], 0.01 to 10: the exponent of
  /// a frame's likelihoods is min(1, seconds / correlation_time).
  double correlation_time = 0.4;
  /// Evidence [nats] that raises the alarm: about exp(threshold) times the correlation time passes
  /// between two false alarms, if errors are independent. 0.001 to 1000.
  double threshold = 7.0;
  /// Lower bound of the probability of a place by one frame: no frame rules a place out. 1e-9 to
  /// 0.1.
  double min_frame_probability = 0.002;
  double stay_probability = 0.7;       ///< of staying in a place for a second, 0 to 1
  double teleport_probability = 5e-3;  ///< per second, of being carried to any place, 0 to 1
  /// The place of a kidnapped robot is known from this probability on, 0 to 1.
  double min_place_probability = 0.9;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

struct KidnappingState {
  bool tested = false;       ///< false: no place is expected at the pose, nothing was compared
  bool kidnapped = false;    ///< the pose is rejected
  bool alarm = false;        ///< the alarm was raised by this image
  double evidence = 0.0;     ///< [nats] that the robot is elsewhere, 0 to threshold
  int place = -1;            ///< where the robot is instead, if kidnapped and known
  double probability = 0.0;  ///< of the most likely place, if kidnapped
};

/// A sequential test (CUSUM, Page 1954) of "the robot is at its pose" against "it is elsewhere and
/// moves from place to place": the evidence is the sum of the log-likelihood ratios of the frames,
/// never below 0; the alarm is raised at the threshold and ends when the evidence is 0 again. Under
/// the second hypothesis the place is unknown: a Bayes filter over the places, which begins again
/// whenever the evidence is 0, predicts each frame. Wrong frames that contradict each other
/// therefore count little.
class KidnappingDetector {
 public:
  /// @throws hyselam::ParameterError; hyselam::InputError without places.
  KidnappingDetector(const PlaceTransitions& transitions, const KidnappingDetectorParams& params);

  /// @param frame probability of each place by this frame alone.
  /// @param expected places that agree with the pose (expectedPlaces()). Empty: the pose is not
  ///   known, or its places were never learned; the frame is then only used to find a kidnapped
  ///   robot.
  /// @param unmapped learned places that are not on the map; none of `expected`. They belong to
  ///   neither hypothesis: a frame is weighted by the probability of all others.
  /// @param seconds since the frame before; negative values count as 0.
  /// @throws hyselam::InputError for a wrong number of probabilities, or places that do not exist.
  KidnappingState update(const std::vector<double>& frame, const std::vector<int>& expected,
                         const std::vector<int>& unmapped = {}, double seconds = 0.2);

  /// Removes all evidence: the pose has been set.
  void reset();

  /// Enters the state after an alarm, when the localization itself reports that it is lost.
  void declareLost();

 private:
  enum class Role { kExpected, kElsewhere, kUnmapped };  // of a place, for the hypotheses

  std::vector<Role> rolesOf(const std::vector<int>& expected,
                            const std::vector<int>& unmapped) const;
  void restart(const std::vector<int>& expected);
  /// One step of the Bayes filter's motion, into next_.
  void predict(double seconds);

  KidnappingDetectorParams params_;
  PlaceDistances paths_;
  std::vector<int> neighbor_counts_;
  std::vector<double> elsewhere_, next_;  // where the robot is, if not at its pose
  double evidence_ = 0.0;
  bool kidnapped_ = false;
};

}  // namespace selovis

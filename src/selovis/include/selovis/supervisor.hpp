// Is the robot where its localisation says? The place that it sees against the place of its pose
// (chapter 6: redundancy; kidnapping).
#pragma once

#include <vector>

#include "selovis/place_filter.hpp"

namespace selovis {

struct SupervisorParams {
  /// Exponent of each frame's likelihoods: frames that follow each other are no independent
  /// witnesses. Above 0, at most 1.
  double trust = 0.5;
  /// Evidence [nats] from which the pose is no longer believed: about exp(threshold) independent
  /// looks pass between two false alarms. Above 0.
  double threshold = 7.0;
  /// No frame rules a place out: probabilities below it count as this. Above 0, at most 0.1.
  double least = 0.002;
  double stay = 0.93;  ///< probability of staying in a place from one frame to the next, 0 to 1
  double leak = 1e-3;  ///< probability of being carried anywhere, 0 to 1
  double known_from = 0.9;  ///< the place is known once it has this probability, 0 to 1
};

/// Throws hyselam::ParameterError.
void validate(const SupervisorParams& params);

struct Supervision {
  bool judged = false;       ///< false: the pose has no place, nothing was compared
  bool kidnapped = false;    ///< the pose is not believed
  bool alarm = false;        ///< this frame made it so
  double evidence = 0.0;     ///< [nats] that the robot is elsewhere, 0 to threshold
  int place = -1;            ///< where the robot is instead, if kidnapped and known
  double probability = 0.0;  ///< of the likeliest place, if kidnapped
};

/// A sequential test (Page 1954) of "the robot is in the place of its pose" against "it is
/// elsewhere and moves from place to place through doors": the evidence is the sum of the
/// log-likelihood ratios of the frames, never below 0, and an alarm is raised where it reaches the
/// threshold. Under the second hypothesis the place is unknown; a filter over the graph of places,
/// begun anew whenever the evidence is 0, says how likely each frame is. Wrong frames that
/// contradict each other therefore count for little. The alarm ends when the evidence has sunk to 0
/// again.
class Supervisor {
 public:
  Supervisor(const PlaceGraph& graph, const SupervisorParams& params);

  /// @param frame probability of each place by this frame alone.
  /// @param here places that agree with the pose: the one it lies in and those it is next to; none:
  ///   not known, or places that were never learnt. The frame then only tells where a kidnapped
  ///   robot is.
  /// @param unmapped places of which nobody knows where they are; none of `here`. They belong to
  ///   neither hypothesis, and a frame counts by the share of it that sees others.
  /// Throws std::invalid_argument for a wrong number of probabilities, or places that are none.
  Supervision update(const std::vector<double>& frame, const std::vector<int>& here,
                     const std::vector<int>& unmapped = {});

  /// Forgets all evidence: the pose has been set anew.
  void reset();

  /// The localisation itself says that it is lost: as after an alarm, the frames from now on tell
  /// where the robot is.
  void doubt();

 private:
  void restart(const std::vector<int>& here);

  SupervisorParams params_;
  PlaceDistances paths_;
  std::vector<int> neighbours_;
  std::vector<double> elsewhere_, next_;  // where the robot is if not where its pose says
  double evidence_ = 0.0;
  bool kidnapped_ = false;
};

}  // namespace selovis

// How well poses explain what the robot sees: the interface of all observation models, p(z | x, m)
// of Alg. 2.1 line 5.
#pragma once

#include "fsd_localization/fsd_sensor.hpp"
#include "fsd_localization/particles.hpp"

namespace fsd_localization {

/// One look at the world. Models take from it what they need.
struct Observation {
  hyselam::LaserScan scan;
  FsdObservation fsd;  ///< without readings where no FSD model asked for them
};

/// (sum of weights / sum before)^(1 / factors); 0 where nothing was left.
double likelihoodPerFactor(double sum_before, double sum_after, double factors);
double totalWeight(const Particles& particles);

class ObservationModel {
 public:
  virtual ~ObservationModel() = default;
  virtual const char* name() const = 0;

  /// Multiplies each weight by the likelihood (up to a common factor) of the observation.
  /// @return the mean likelihood per independent factor (beam, density, direction) over the
  /// weighted
  ///   particles, what recovery watches; empty if the observation told nothing and the weights are
  ///   unchanged.
  virtual std::optional<double> weigh(const Observation& observation,
                                      Particles& particles) const = 0;
};

}  // namespace fsd_localization

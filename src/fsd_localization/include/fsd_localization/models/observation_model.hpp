// How well poses explain what the robot sees: the interface of all observation models, p(z | x, m)
// of Alg. 2.1 line 5.
#pragma once

#include <optional>
#include <string>

#include "fsd_localization/density/fsd_sensor.hpp"
#include "fsd_localization/filter/particles.hpp"

namespace fsd_localization {

/// The model by which a localizer weighs its particles.
enum class ObservationModelKind {
  kFsd,         ///< free-space density (chapter 3)
  kBeam,        ///< beam model by ray casting, "bb" in the thesis
  kCosine,      ///< cosine similarity of expected and measured scan, "fcs" in the thesis
  kLikelihood,  ///< likelihood field
  kHybrid,      ///< FSD until few places are left, then the likelihood field (3.5)
};
/// "fsd", "beam", "cosine", "likelihood", "hybrid".
/// @throws hyselam::ParameterError for other names.
ObservationModelKind observationModelKindFromString(const std::string& name);
const char* toString(ObservationModelKind kind);

/// The scan of one moment and what was derived from it. Models take from it what they need.
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
  ///   weighted particles, by which recovery decides; empty if the observation holds nothing for
  ///   this model, and the weights are unchanged.
  virtual std::optional<double> weigh(const Observation& observation,
                                      Particles& particles) const = 0;
};

}  // namespace fsd_localization

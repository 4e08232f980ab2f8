// Monte Carlo localisation (Maffei 2017, 2.1.1, Alg. 2.1): move, weigh, resample; with resampling
// on the effective sample size, adaptive size and recovery by random particles.
#pragma once

#include <memory>

#include "fsd_localization/filter/motion_model.hpp"
#include "fsd_localization/filter/particles.hpp"
#include "fsd_localization/models/observation_model.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct FilterParams {
  std::size_t min_particles = 500;    ///< smallest adaptive size
  std::size_t max_particles = 20000;  ///< size of a global search; the fixed size without adaption
  double resample_threshold = 0.5;    ///< resample when the effective size falls below this share
  bool adaptive_size = false;         ///< KLD sampling (Fox 2003)
  double kld_error = 0.02;            ///< KL distance allowed
  double kld_z = 2.33;                ///< quantile of the confidence: 2.33 is 99 %
  double recovery_alpha_slow =
      0.0;  ///< decay of the slow average of the likelihood; 0: no recovery
  double recovery_alpha_fast = 0.0;  ///< decay of the fast one
  double recovery_slack = 1.1;  ///< >= 1; how far fast may fall below slow before particles are
                                ///< replaced by random ones (nu of Gutmann, Fox 2002)
  MotionParams motion;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;
};

struct FilterStep {
  std::optional<double> likelihood;  ///< per factor; empty if the observation held nothing
  double effective_size = 0.0;       ///< after weighing, before resampling
  bool resampled = false;
  std::size_t injected = 0;  ///< number of random particles injected
};

class ParticleFilter {
 public:
  /// The map gives the free cells that particles start on. Equal seeds give equal filters.
  ParticleFilter(std::shared_ptr<const FsdMap> map, const FilterParams& params, std::uint64_t seed);

  /// Spreads the particles uniformly over the free space.
  void spreadOverMap();
  /// Draws the particles around a pose in the grid's frame; standard deviations [m, m, rad].
  void concentrateAround(const hyselam::Pose2& mean, const hyselam::Pose2& stddev);
  /// Sets the particles (any weights); their number becomes the size.
  void setParticles(Particles particles);

  /// One round of Alg. 2.1. @param delta motion since the last step, in the old base frame.
  /// @param motion_noise see MotionModel::move.
  FilterStep step(const hyselam::Pose2& delta, const ObservationModel& model,
                  const Observation& observation, double motion_noise = 1.0);

  const Particles& particles() const { return particles_; }
  const FilterParams& params() const { return params_; }
  /// A copy with n particles, drawn by weight and blurred by the standard deviations [m, m, rad].
  Particles resampledCopy(std::size_t n, const hyselam::Pose2& blur);

 private:
  std::uint64_t nextStream() { return hyselam::mix(seed_, ++steps_); }
  void inject(std::size_t count);

  std::shared_ptr<const FsdMap> map_;
  FilterParams params_;
  MotionModel motion_;
  std::uint64_t seed_;
  std::uint64_t steps_ = 0;
  Particles particles_;
  Particles scratch_;
  double likelihood_slow_ = 0.0;
  double likelihood_fast_ = 0.0;
};

}  // namespace fsd_localization

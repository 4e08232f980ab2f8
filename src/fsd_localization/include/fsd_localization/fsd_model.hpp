// The free-space density observation model (thesis 3.3.1, Eq. 3.3 to 3.6): one table look-up per
// kernel and particle.
#pragma once

#include <memory>

#include "fsd_localization/fsd_map.hpp"
#include "fsd_localization/observation_model.hpp"

namespace fsd_localization {

struct FsdModelParams {
  /// What a density without a hard value tells.
  enum class Undefined {
    kNeutral,  ///< nothing: factor 1 for all (the thesis, Eq. 3.4)
    kBounds,   ///< the true density lies between the soft value and its upper bound
  };
  /// How a factor falls from 1 to `penalty` as reading and map disagree.
  enum class Profile {
    kStep,      ///< at once, where the tolerance ends (the thesis, Eq. 3.4 and 3.5)
    kGaussian,  ///< smoothly; the tolerance is two standard deviations
  };
  Profile profile = Profile::kGaussian;
  double epsilon_d = 0.2;                         ///< density tolerance
  double epsilon_theta = hyselam::radians(45.0);  ///< direction tolerance [rad]
  double penalty = 0.5;            ///< factor for a density or direction out of tolerance
  double occupied_penalty = 0.01;  ///< factor for a pose on a cell that is not free
  Undefined undefined = Undefined::kBounds;

  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;
};

class FsdModel final : public ObservationModel {
 public:
  explicit FsdModel(std::shared_ptr<const FsdMap> map, const FsdModelParams& params = {});
  const char* name() const override { return "fsd"; }
  /// @throws hyselam::InputError if the observation has not one reading per kernel of the map.
  std::optional<double> weigh(const Observation& observation, Particles& particles) const override;

  const FsdModelParams& params() const { return params_; }

 private:
  template <int Kernels>
  void weighAll(const float* density_factor, const float* direction_factor, Particles& p) const;

  std::shared_ptr<const FsdMap> map_;
  FsdModelParams params_;
};

}  // namespace fsd_localization

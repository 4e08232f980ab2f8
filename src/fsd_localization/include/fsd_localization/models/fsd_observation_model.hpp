// The free-space density observation model (Maffei 2017, 3.3.1, Eq. 3.3 to 3.6; the weights are Eq.
// 3.4 and 3.5): one table look-up per kernel and particle.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "fsd_localization/density/fsd_map.hpp"
#include "fsd_localization/models/observation_model.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct FsdObservationModelParams {
  /// How a density without a hard value weighs.
  enum class Undefined {
    kNeutral,  ///< not at all: factor 1 for all (the thesis, Eq. 3.4)
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

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;
};

class FsdObservationModel final : public ObservationModel {
 public:
  explicit FsdObservationModel(std::shared_ptr<const FsdMap> map,
                               const FsdObservationModelParams& params = {});
  const char* name() const override { return "fsd"; }
  /// @throws hyselam::InputError if the observation has not one reading per kernel of the map.
  std::optional<double> weigh(const Observation& observation, Particles& particles) const override;

  const FsdObservationModelParams& params() const { return params_; }

 private:
  /// Eq. 3.4 and 3.5 for every value that the two bytes of a cell can hold, kernel by kernel.
  struct FactorTables {
    std::vector<float> density;    ///< index 256 k + density byte
    std::vector<float> direction;  ///< index 256 k + direction byte, relative to the heading
    int factors = 0;               ///< densities and directions that the observation holds
  };
  FactorTables factorTables(const std::vector<FsdReading>& readings) const;
  float agreement(double excess, double tolerance) const;
  template <int Kernels>
  void weighAll(const float* density_factor, const float* direction_factor, Particles& p) const;

  std::shared_ptr<const FsdMap> map_;
  FsdObservationModelParams params_;
};

}  // namespace fsd_localization

// Beam-based observation model by ray casting ("bb", Fox, Burgard, Thrun 1999; Maffei 2017, 2.1.1),
// one of those that FSD is compared with.
#pragma once

#include <memory>

#include "fsd_localization/models/grid_ray_caster.hpp"
#include "fsd_localization/models/observation_model.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct BeamModelParams {
  int max_beams = 19;         ///< the thesis: one each 10 degrees
  double max_range = 20.0;    ///< [m]
  double z_hit = 0.8;         ///< share of returns from the mapped obstacle
  double z_short = 0.1;       ///< share of returns from unmapped obstacles before it
  double z_max = 0.05;        ///< share of beams without return
  double z_rand = 0.05;       ///< share of returns from anywhere
  double sigma_hit = 0.2;     ///< [m]
  double lambda_short = 0.1;  ///< [1/m]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

class BeamModel final : public ObservationModel {
 public:
  explicit BeamModel(std::shared_ptr<const GridRayCaster> map, const BeamModelParams& params = {});
  const char* name() const override { return "beam"; }
  std::optional<double> weigh(const Observation& observation, Particles& particles) const override;

 private:
  std::shared_ptr<const GridRayCaster> map_;
  BeamModelParams params_;
};

}  // namespace fsd_localization

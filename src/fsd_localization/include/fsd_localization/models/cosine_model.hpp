// Observation model by the cosine similarity of ranges ("fcs", Maffei 2017, Eq. 3.7 and 3.8), one
// of those that FSD is compared with.
#pragma once

#include <memory>

#include "fsd_localization/models/grid_ray_caster.hpp"
#include "fsd_localization/models/observation_model.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct CosineModelParams {
  int max_beams = 19;
  double max_range = 20.0;  ///< [m]
  double exponent = 4.0;    ///< Eq. 3.8

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

class CosineModel final : public ObservationModel {
 public:
  explicit CosineModel(std::shared_ptr<const GridRayCaster> map,
                       const CosineModelParams& params = {});
  const char* name() const override { return "cosine"; }
  std::optional<double> weigh(const Observation& observation, Particles& particles) const override;

 private:
  std::shared_ptr<const GridRayCaster> map_;
  CosineModelParams params_;
};

}  // namespace fsd_localization

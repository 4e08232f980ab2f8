#include "fsd_localization/models/cosine_model.hpp"

#include <cmath>

#include "fsd_localization/models/beam_sample.hpp"

namespace fsd_localization {

using hyselam::Range;

void CosineModelParams::describe(hyselam::ParameterVisitor& visit) {
  visit("max_beams", max_beams, Range::between(1, 10000), "", "beams used of a scan");
  describeMaxRange(visit, max_range);
  visit("exponent", exponent, Range::between(0.1, 1000.0), "", "of the similarity, Eq. 3.8");
}

void CosineModelParams::validate() const {
  hyselam::checkParameters(*this);
  checkMaxRange(max_range);
}

CosineModel::CosineModel(std::shared_ptr<const GridRayCaster> map, const CosineModelParams& params)
    : map_(std::move(map)), params_((params.validate(), params)) {}

std::optional<double> CosineModel::weigh(const Observation& observation, Particles& p) const {
  const BeamSample beams =
      sampleBeams(observation.scan, params_.max_beams, params_.max_range, true);
  double norm_r = 0.0;
  for (float r : beams.range) norm_r += static_cast<double>(r) * r;
  if (!(norm_r > 0.0)) return std::nullopt;
  const double before = totalWeight(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const hyselam::Pose2 laser = laserPose(p, i, beams.laser_in_base);
    double dot = 0.0, norm_p = 0.0;
    for (std::size_t b = 0; b < beams.range.size(); ++b) {
      const double expected =
          map_->range(laser.x, laser.y, laser.theta + beams.bearing[b], beams.max_range);
      dot += expected * beams.range[b];
      norm_p += expected * expected;
    }
    const double cosine = norm_p > 0.0 ? dot / std::sqrt(norm_p * norm_r) : 0.0;
    p.weight[i] = static_cast<float>(p.weight[i] * std::pow(cosine, params_.exponent));
  }
  return likelihoodPerFactor(before, totalWeight(p), 1.0);
}

}  // namespace fsd_localization

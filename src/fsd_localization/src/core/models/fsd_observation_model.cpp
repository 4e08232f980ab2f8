#include "fsd_localization/models/fsd_observation_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::Range;

void FsdObservationModelParams::describe(hyselam::ParameterVisitor& visit) {
  visit("epsilon_d", epsilon_d, Range::aboveUpTo(0.0, 1.0), "", "tolerance of densities");
  visit("epsilon_theta", epsilon_theta, Range::aboveUpTo(0.0, hyselam::kPi), "rad",
        "tolerance of directions");
  visit("penalty", penalty, Range::inside(0.0, 1.0), "", "factor beyond a tolerance");
  visit("occupied_penalty", occupied_penalty, Range::aboveUpTo(0.0, 1.0), "",
        "factor where the map is not free");
  visit("profile", profile, {{"step", Profile::kStep}, {"gaussian", Profile::kGaussian}},
        "how the factor falls to the penalty within the tolerance");
  visit("undefined", undefined, {{"neutral", Undefined::kNeutral}, {"bounds", Undefined::kBounds}},
        "how a density without a hard value weighs: not at all, or by its bounds");
}

void FsdObservationModelParams::validate() const {
  hyselam::checkParameters(*this);
}

FsdObservationModel::FsdObservationModel(std::shared_ptr<const FsdMap> map,
                                         const FsdObservationModelParams& params)
    : map_(std::move(map)), params_(params) {
  params_.validate();
}

float FsdObservationModel::agreement(double excess, double tolerance) const {
  const double floor = params_.penalty;
  if (params_.profile == FsdObservationModelParams::Profile::kStep) {
    return static_cast<float>(excess > tolerance ? floor : 1.0);
  }
  const double z = 2.0 * excess / tolerance;  // the tolerance is two standard deviations
  return static_cast<float>(floor + (1.0 - floor) * std::exp(-0.5 * z * z));
}

FsdObservationModel::FactorTables FsdObservationModel::factorTables(
    const std::vector<FsdReading>& readings) const {
  const std::size_t kernels = readings.size();
  FactorTables tables;
  tables.density.assign(kernels * 256, 1.0F);
  tables.direction.assign(kernels * 256, 1.0F);
  for (std::size_t k = 0; k < kernels; ++k) {
    const FsdReading& reading = readings[k];
    const double low = reading.density.soft, high = reading.density.upper;
    const bool informative =
        reading.density.hard.has_value() ||
        (params_.undefined == FsdObservationModelParams::Undefined::kBounds && high - low < 1.0);
    if (informative) {  // Eq. 3.4
      ++tables.factors;
      for (int b = 0; b <= FsdMap::kMaxDensity; ++b) {
        const double d = b / static_cast<double>(FsdMap::kMaxDensity);
        tables.density[k * 256 + static_cast<std::size_t>(b)] =
            agreement(std::max({0.0, low - d, d - high}), params_.epsilon_d);
      }
    }
    if (reading.descent) {  // Eq. 3.5
      ++tables.factors;
      for (int a = 0; a < 128; ++a) {
        const double difference =
            hyselam::normalizeAngle(a * (2.0 * hyselam::kPi / 128.0) - *reading.descent);
        tables.direction[k * 256 + static_cast<std::size_t>(FsdMap::kStable | a)] =
            agreement(std::abs(difference), params_.epsilon_theta);
      }
    }
    // A pose in a wall is wrong once, not once per kernel.
    tables.density[k * 256 + FsdMap::kNotFree] =
        k == 0 ? static_cast<float>(params_.occupied_penalty) : 1.0F;
  }
  return tables;
}

std::optional<double> FsdObservationModel::weigh(const Observation& observation,
                                                 Particles& particles) const {
  const auto& readings = observation.fsd.readings;
  const int kernels = map_->kernelCount();
  if (static_cast<int>(readings.size()) != kernels) {
    throw hyselam::InputError("observation", "density readings",
                              "have " + std::to_string(readings.size()) + " kernels, the map has " +
                                  std::to_string(kernels));
  }
  const FactorTables tables = factorTables(readings);
  if (tables.factors == 0) return std::nullopt;
  const double before = totalWeight(particles);
  const float* density = tables.density.data();
  const float* direction = tables.direction.data();
  switch (kernels) {
    case 1:
      weighAll<1>(density, direction, particles);
      break;
    case 2:
      weighAll<2>(density, direction, particles);
      break;
    case 3:
      weighAll<3>(density, direction, particles);
      break;
    case 4:
      weighAll<4>(density, direction, particles);
      break;
    default:
      weighAll<0>(density, direction, particles);
  }
  return likelihoodPerFactor(before, totalWeight(particles), tables.factors);
}

/// Kernels: their number, or 0 for "ask the map".
template <int Kernels>
void FsdObservationModel::weighAll(const float* density_factor, const float* direction_factor,
                                   Particles& p) const {
  const hyselam::GridGeometry& g = map_->geometry();
  const auto per_meter = static_cast<float>(1.0 / g.resolution);
  const auto width = static_cast<float>(g.width), height = static_cast<float>(g.height);
  const int kernels = Kernels > 0 ? Kernels : map_->kernelCount();
  const std::size_t stride = static_cast<std::size_t>(map_->cellStride());
  const std::uint8_t* const cells = map_->data();
  const std::uint8_t outside[16] = {FsdMap::kNotFree, 0, FsdMap::kNotFree, 0, FsdMap::kNotFree, 0,
                                    FsdMap::kNotFree, 0, FsdMap::kNotFree, 0, FsdMap::kNotFree, 0,
                                    FsdMap::kNotFree, 0, FsdMap::kNotFree, 0};
  constexpr std::size_t kBlock = 64;  // cells are prefetched this far ahead of their use
  const std::uint8_t* cell_of[kBlock];
  const std::size_t n = p.size();
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t count = std::min(kBlock, n - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const float cx = p.x[begin + i] * per_meter, cy = p.y[begin + i] * per_meter;
      const bool inside = cx >= 0.0F && cy >= 0.0F && cx < width && cy < height;
      cell_of[i] = inside ? cells + (static_cast<std::size_t>(static_cast<std::int32_t>(cy)) *
                                         static_cast<std::size_t>(g.width) +
                                     static_cast<std::size_t>(static_cast<std::int32_t>(cx))) *
                                        stride
                          : outside;
      __builtin_prefetch(cell_of[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* cell = cell_of[i];
      const auto heading = static_cast<std::uint8_t>((p.heading[begin + i] + 0x01000000U) >> 25);
      float w = p.weight[begin + i];
      for (int k = 0; k < kernels; ++k) {
        const std::uint8_t density = cell[2 * k], direction = cell[2 * k + 1];
        const auto relative =
            static_cast<std::uint8_t>(((direction - heading) & 0x7F) | (direction & 0x80));
        w *= density_factor[k * 256 + density] * direction_factor[k * 256 + relative];
      }
      p.weight[begin + i] = w;
    }
  }
}

}  // namespace fsd_localization

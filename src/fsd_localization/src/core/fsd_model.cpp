#include "fsd_localization/fsd_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

void FsdModelParams::validate() const {
  if (!(epsilon_d > 0.0 && epsilon_d <= 1.0))
    throw hyselam::ParameterError("epsilon_d", epsilon_d, "in (0, 1]");
  if (!(epsilon_theta > 0.0 && epsilon_theta <= hyselam::kPi))
    throw hyselam::ParameterError("epsilon_theta", epsilon_theta, "in (0, pi] rad");
  if (!(penalty > 0.0 && penalty < 1.0))
    throw hyselam::ParameterError("penalty", penalty, "in (0, 1)");
  if (!(occupied_penalty > 0.0 && occupied_penalty <= 1.0))
    throw hyselam::ParameterError("occupied_penalty", occupied_penalty, "in (0, 1]");
}

FsdModel::FsdModel(std::shared_ptr<const FsdMap> map, const FsdModelParams& params)
    : map_(std::move(map)), params_(params) {
  params_.validate();
}

std::optional<double> FsdModel::weigh(const Observation& observation, Particles& particles) const {
  const auto& readings = observation.fsd.readings;
  const int kernels = map_->kernelCount();
  if (static_cast<int>(readings.size()) != kernels)
    throw hyselam::InputError("observation", "density readings",
                              "have " + std::to_string(readings.size()) + " kernels, the map has " +
                                  std::to_string(kernels));
  // Eq. 3.4 and 3.5 for every value that a cell can hold.
  std::vector<float> density_factor(static_cast<std::size_t>(kernels) * 256, 1.0F);
  std::vector<float> direction_factor(static_cast<std::size_t>(kernels) * 256, 1.0F);
  const double floor = params_.penalty;
  // The agreement fades with the excess over what fits, or breaks off at the tolerance.
  const auto fade = [&](double excess, double tolerance) {
    if (params_.profile == FsdModelParams::Profile::kStep)
      return static_cast<float>(excess > tolerance ? floor : 1.0);
    const double z = 2.0 * excess / tolerance;
    return static_cast<float>(floor + (1.0 - floor) * std::exp(-0.5 * z * z));
  };
  int factors = 0;
  for (int k = 0; k < kernels; ++k) {
    const FsdReading& reading = readings[static_cast<std::size_t>(k)];
    float* by_density = &density_factor[static_cast<std::size_t>(k) * 256];
    float* by_direction = &direction_factor[static_cast<std::size_t>(k) * 256];
    const bool told = reading.density.hard.has_value() ||
                      (params_.undefined == FsdModelParams::Undefined::kBounds &&
                       reading.density.upper - reading.density.soft < 1.0);
    if (told) {
      ++factors;
      const double low = reading.density.soft;
      const double high = reading.density.upper;
      for (int b = 0; b <= FsdMap::kMaxDensity; ++b) {
        const double d = b / static_cast<double>(FsdMap::kMaxDensity);
        by_density[b] = fade(std::max({0.0, low - d, d - high}), params_.epsilon_d);
      }
    }
    if (reading.descent) {
      ++factors;
      for (int a = 0; a < 128; ++a) {
        const double difference =
            hyselam::normalizeAngle(a * (2.0 * hyselam::kPi / 128.0) - *reading.descent);
        by_direction[FsdMap::kStable | a] = fade(std::abs(difference), params_.epsilon_theta);
      }
    }
  }
  for (int k = 0; k < kernels; ++k)  // a pose in a wall is wrong once, not once per kernel
    density_factor[static_cast<std::size_t>(k) * 256 + FsdMap::kNotFree] =
        k == 0 ? static_cast<float>(params_.occupied_penalty) : 1.0F;
  if (factors == 0) return std::nullopt;
  const double before = totalWeight(particles);

  switch (kernels) {
    case 1:
      weighAll<1>(density_factor.data(), direction_factor.data(), particles);
      break;
    case 2:
      weighAll<2>(density_factor.data(), direction_factor.data(), particles);
      break;
    case 3:
      weighAll<3>(density_factor.data(), direction_factor.data(), particles);
      break;
    case 4:
      weighAll<4>(density_factor.data(), direction_factor.data(), particles);
      break;
    default:
      weighAll<0>(density_factor.data(), direction_factor.data(), particles);
  }
  return likelihoodPerFactor(before, totalWeight(particles), factors);
}

/// Kernels: their number, or 0 for "ask the map".
template <int Kernels>
void FsdModel::weighAll(const float* density_factor, const float* direction_factor,
                        Particles& p) const {
  const hyselam::GridGeometry& g = map_->geometry();
  const auto per_metre = static_cast<float>(1.0 / g.resolution);
  const auto width = static_cast<float>(g.width), height = static_cast<float>(g.height);
  const int kernels = Kernels > 0 ? Kernels : map_->kernelCount();
  const std::size_t stride = static_cast<std::size_t>(map_->cellStride());
  const std::uint8_t* const cells = map_->data();
  const std::uint8_t outside[16] = {FsdMap::kNotFree, 0, FsdMap::kNotFree, 0, FsdMap::kNotFree, 0,
                                    FsdMap::kNotFree, 0, FsdMap::kNotFree, 0, FsdMap::kNotFree, 0,
                                    FsdMap::kNotFree, 0, FsdMap::kNotFree, 0};
  constexpr std::size_t kBlock = 64;  // cells are asked for this far ahead of their use
  const std::uint8_t* where[kBlock];
  const std::size_t n = p.size();
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t count = std::min(kBlock, n - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const float cx = p.x[begin + i] * per_metre, cy = p.y[begin + i] * per_metre;
      const bool inside = cx >= 0.0F && cy >= 0.0F && cx < width && cy < height;
      where[i] = inside ? cells + (static_cast<std::size_t>(static_cast<std::int32_t>(cy)) *
                                       static_cast<std::size_t>(g.width) +
                                   static_cast<std::size_t>(static_cast<std::int32_t>(cx))) *
                                      stride
                        : outside;
      __builtin_prefetch(where[i]);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* cell = where[i];
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

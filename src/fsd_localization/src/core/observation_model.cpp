#include "fsd_localization/observation_model.hpp"

#include <cmath>

namespace fsd_localization {

double likelihoodPerFactor(double sum_before, double sum_after, double factors) {
  return sum_before > 0.0 && factors > 0.0 ? std::pow(sum_after / sum_before, 1.0 / factors) : 0.0;
}

double totalWeight(const Particles& particles) {
  double sum = 0.0;
  for (float w : particles.weight) sum += w;
  return sum;
}

}  // namespace fsd_localization

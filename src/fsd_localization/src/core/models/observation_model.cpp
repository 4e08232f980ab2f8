#include "fsd_localization/models/observation_model.hpp"

#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

namespace {
constexpr std::pair<ObservationModelKind, const char*> kNames[] = {
    {ObservationModelKind::kFsd, "fsd"},
    {ObservationModelKind::kBeam, "beam"},
    {ObservationModelKind::kCosine, "cosine"},
    {ObservationModelKind::kLikelihood, "likelihood"},
    {ObservationModelKind::kHybrid, "hybrid"}};
}  // namespace

ObservationModelKind observationModelKindFromString(const std::string& name) {
  for (const auto& [kind, text] : kNames) {
    if (name == text) return kind;
  }
  throw hyselam::ParameterError("model", name, "one of fsd, beam, cosine, likelihood, hybrid");
}

const char* toString(ObservationModelKind kind) {
  for (const auto& [k, text] : kNames) {
    if (k == kind) return text;
  }
  return "?";
}

double likelihoodPerFactor(double sum_before, double sum_after, double factors) {
  return sum_before > 0.0 && factors > 0.0 ? std::pow(sum_after / sum_before, 1.0 / factors) : 0.0;
}

double totalWeight(const Particles& particles) {
  double sum = 0.0;
  for (float w : particles.weight) sum += w;
  return sum;
}

}  // namespace fsd_localization

#include "fsd_localization/particle_filter.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::ParameterError;
using hyselam::Pose2;

namespace {
constexpr double kKldCell = 0.5;                      // [m]
constexpr double kKldAngle = hyselam::radians(15.0);  // [rad]

/// Weights that steps without resampling have multiplied far from 1 come back before a float cannot
/// hold them any more. By a power of two: their ratios stay exactly as they are.
void keepInRange(Particles& particles) {
  constexpr int kFar = 32;
  const double mean = totalWeight(particles) / static_cast<double>(particles.size());
  if (!(mean > 0.0) || !std::isfinite(mean) || std::abs(std::ilogb(mean)) < kFar) return;
  const double scale = std::ldexp(1.0, -std::ilogb(mean));
  for (float& w : particles.weight) w = static_cast<float>(w * scale);
}
}  // namespace

void FilterParams::validate() const {
  if (min_particles < 1) throw ParameterError("min_particles", min_particles, ">= 1");
  if (max_particles < min_particles || max_particles > 10000000)
    throw ParameterError("max_particles", max_particles, "between min_particles and 10^7");
  if (!(resample_below > 0.0 && resample_below <= 1.0))
    throw ParameterError("resample_below", resample_below, "in (0, 1]");
  if (!(kld_error > 0.0 && kld_error < 1.0))
    throw ParameterError("kld_err", kld_error, "in (0, 1)");
  if (!(kld_z > 0.0 && kld_z < 10.0)) throw ParameterError("kld_z", kld_z, "in (0, 10)");
  if (!(recovery_alpha_slow >= 0.0 && recovery_alpha_slow < 1.0))
    throw ParameterError("recovery_alpha_slow", recovery_alpha_slow, "in [0, 1)");
  if (!(recovery_alpha_fast >= recovery_alpha_slow && recovery_alpha_fast < 1.0))
    throw ParameterError("recovery_alpha_fast", recovery_alpha_fast, "in [recovery_alpha_slow, 1)");
  if (!(recovery_slack >= 1.0 && recovery_slack < 100.0))
    throw ParameterError("recovery_slack", recovery_slack, "in [1, 100)");
  motion.validate();
}

ParticleFilter::ParticleFilter(std::shared_ptr<const FsdMap> map, const FilterParams& params,
                               std::uint64_t seed)
    : map_(std::move(map)),
      params_((params.validate(), params)),
      motion_(params.motion),
      seed_(seed) {
  spread();
}

void ParticleFilter::spread() {
  take(uniformParticles(*map_, params_.max_particles, nextStream()));
}

void ParticleFilter::concentrate(const Pose2& mean, const Pose2& stddev) {
  take(gaussianParticles(mean, stddev, params_.max_particles, nextStream()));
}

void ParticleFilter::take(Particles particles) {
  particles_ = std::move(particles);
  likelihood_slow_ = likelihood_fast_ = 0.0;
}

FilterStep ParticleFilter::step(const Pose2& delta, const ObservationModel& model,
                                const Observation& observation) {
  FilterStep result;
  motion_.move(delta, nextStream(), particles_);
  result.likelihood = model.weigh(observation, particles_);
  result.effective_size = effectiveSampleSize(particles_);

  double replaced_share = 0.0;
  if (result.likelihood && params_.recovery_alpha_slow > 0.0) {
    const double l = *result.likelihood;
    likelihood_slow_ +=
        (likelihood_slow_ == 0.0 ? 1.0 : params_.recovery_alpha_slow) * (l - likelihood_slow_);
    likelihood_fast_ +=
        (likelihood_fast_ == 0.0 ? 1.0 : params_.recovery_alpha_fast) * (l - likelihood_fast_);
    if (likelihood_slow_ > 0.0)
      replaced_share =
          std::max(0.0, 1.0 - params_.recovery_slack * likelihood_fast_ / likelihood_slow_);
  }
  // Weights only change, and only ask for resampling, when something was seen.
  const bool starved =
      result.effective_size < params_.resample_below * static_cast<double>(particles_.size());
  if (!result.likelihood) return result;
  if (!starved && replaced_share == 0.0) {
    keepInRange(particles_);
    return result;
  }

  std::size_t n = params_.max_particles;
  if (params_.adaptive_size)
    n = std::clamp(kldSampleSize(occupiedBins(particles_, kKldCell, kKldAngle), params_.kld_error,
                                 params_.kld_z),
                   params_.min_particles, params_.max_particles);
  resampleSystematic(particles_, n, toUnit(hashAt(nextStream(), 0)), scratch_);
  std::swap(particles_, scratch_);
  result.resampled = true;
  result.injected = static_cast<std::size_t>(replaced_share * static_cast<double>(n));
  inject(result.injected);
  return result;
}

void ParticleFilter::inject(std::size_t count) {
  if (count == 0) return;
  const Particles fresh = uniformParticles(*map_, count, nextStream());
  const double every = static_cast<double>(particles_.size()) / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i)
    particles_.set(static_cast<std::size_t>(static_cast<double>(i) * every), fresh.pose(i), 1.0F);
}

Particles ParticleFilter::resampledCopy(std::size_t n, const Pose2& blur) {
  Particles copy;
  resampleSystematic(particles_, n, toUnit(hashAt(nextStream(), 0)), copy);
  const Particles noise = gaussianParticles({}, blur, n, nextStream());
  for (std::size_t i = 0; i < n; ++i) {
    copy.x[i] += noise.x[i];
    copy.y[i] += noise.y[i];
    copy.heading[i] += noise.heading[i];
  }
  return copy;
}

}  // namespace fsd_localization

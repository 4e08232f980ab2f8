#include "fsd_localization/filter/particle_filter.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::ParameterError;
using hyselam::Pose2;
using hyselam::Range;

namespace {
constexpr double kKldCell = 0.5;                      // [m]
constexpr double kKldAngle = hyselam::radians(15.0);  // [rad]

/// Weights that steps without resampling have multiplied far from 1 come back before a float cannot
/// hold them any more. By a power of two: their ratios stay exactly as they are.
void rescaleWeights(Particles& particles) {
  constexpr int kMaxExponent = 32;
  const double mean = totalWeight(particles) / static_cast<double>(particles.size());
  if (!(mean > 0.0) || !std::isfinite(mean) || std::abs(std::ilogb(mean)) < kMaxExponent) return;
  const double scale = std::ldexp(1.0, -std::ilogb(mean));
  for (float& w : particles.weight) w = static_cast<float>(w * scale);
}
}  // namespace

void FilterParams::describe(hyselam::ParameterVisitor& visit) {
  visit("max_particles", max_particles, Range::between(1, 1e7), "",
        "of a global search; of everything without adaptive_size");
  min_particles = std::min(min_particles, max_particles);  // the default, where few are wanted
  visit("min_particles", min_particles, Range::between(1, 1e7), "", "smallest adaptive size");
  visit("adaptive_size", adaptive_size, "KLD sampling; off: always max_particles");
  visit("kld_err", kld_error, Range::inside(0.0, 1.0), "", "Kullback-Leibler distance allowed");
  visit("kld_z", kld_z, Range::inside(0.0, 10.0), "", "quantile of the confidence; 2.33 is 99 %");
  visit.renamed("resample_below", "resample_threshold");
  visit("resample_threshold", resample_threshold, Range::aboveUpTo(0.0, 1.0), "",
        "resample when the effective sample size falls below this share of the particles");
  visit("recovery_alpha_slow", recovery_alpha_slow, Range::fromBelow(0.0, 1.0), "",
        "decay of the slow average of the likelihood; 0: no random particles");
  visit("recovery_alpha_fast", recovery_alpha_fast, Range::fromBelow(0.0, 1.0), "",
        "decay of the fast average");
  visit("recovery_slack", recovery_slack, Range::fromBelow(1.0, 100.0), "",
        "how far the fast average may fall below the slow one");
  visit.group("odom_", motion);
}

void FilterParams::validate() const {
  hyselam::checkParameters(*this);
  if (max_particles < min_particles) {
    throw ParameterError("max_particles", max_particles, "between min_particles and 10^7");
  }
  if (!(recovery_alpha_fast >= recovery_alpha_slow)) {
    throw ParameterError("recovery_alpha_fast", recovery_alpha_fast, "in [recovery_alpha_slow, 1)");
  }
}

ParticleFilter::ParticleFilter(std::shared_ptr<const FsdMap> map, const FilterParams& params,
                               std::uint64_t seed)
    : map_(std::move(map)),
      params_((params.validate(), params)),
      motion_(params.motion),
      seed_(seed) {
  spreadOverMap();
}

void ParticleFilter::spreadOverMap() {
  setParticles(uniformParticles(*map_, params_.max_particles, nextStream()));
}

void ParticleFilter::concentrateAround(const Pose2& mean, const Pose2& stddev) {
  setParticles(gaussianParticles(mean, stddev, params_.max_particles, nextStream()));
}

void ParticleFilter::setParticles(Particles particles) {
  particles_ = std::move(particles);
  likelihood_slow_ = likelihood_fast_ = 0.0;
}

FilterStep ParticleFilter::step(const Pose2& delta, const ObservationModel& model,
                                const Observation& observation, double motion_noise) {
  FilterStep result;
  motion_.move(delta, nextStream(), particles_, motion_noise);
  result.likelihood = model.weigh(observation, particles_);
  result.effective_size = effectiveSampleSize(particles_);

  double replaced_share = 0.0;
  if (result.likelihood && params_.recovery_alpha_slow > 0.0) {
    const double l = *result.likelihood;
    likelihood_slow_ +=
        (likelihood_slow_ == 0.0 ? 1.0 : params_.recovery_alpha_slow) * (l - likelihood_slow_);
    likelihood_fast_ +=
        (likelihood_fast_ == 0.0 ? 1.0 : params_.recovery_alpha_fast) * (l - likelihood_fast_);
    if (likelihood_slow_ > 0.0) {
      replaced_share =
          std::max(0.0, 1.0 - params_.recovery_slack * likelihood_fast_ / likelihood_slow_);
    }
  }
  // Weights only change, and only call for resampling, when the observation held something.
  const bool degenerate =
      result.effective_size < params_.resample_threshold * static_cast<double>(particles_.size());
  if (!result.likelihood) return result;
  if (!degenerate && replaced_share == 0.0) {
    rescaleWeights(particles_);
    return result;
  }

  std::size_t n = params_.max_particles;
  if (params_.adaptive_size) {
    n = std::clamp(kldSampleSize(occupiedBins(particles_, kKldCell, kKldAngle), params_.kld_error,
                                 params_.kld_z),
                   params_.min_particles, params_.max_particles);
  }
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
  for (std::size_t i = 0; i < count; ++i) {
    particles_.set(static_cast<std::size_t>(static_cast<double>(i) * every), fresh.pose(i), 1.0F);
  }
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

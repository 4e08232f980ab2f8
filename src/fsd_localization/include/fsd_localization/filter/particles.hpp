// The particle set of Monte Carlo localisation (thesis 2.1.1, Eq. 2.2), laid out for speed.
#pragma once

#include <vector>

#include "fsd_localization/density/fsd_map.hpp"
#include "fsd_localization/filter/binary_angle.hpp"

namespace fsd_localization {

/// Poses of the base in the *grid's* frame (corner of cell (0, 0), axes along rows and columns): a
/// map with a rotated origin costs nothing per particle. Positions [m].
struct Particles {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<BinaryAngle> heading;
  std::vector<float> weight;  ///< >= 0, not normalized

  std::size_t size() const { return x.size(); }
  void resize(std::size_t n) {
    x.resize(n);
    y.resize(n);
    heading.resize(n);
    weight.resize(n);
  }
  void set(std::size_t i, const hyselam::Pose2& p, float w) {
    x[i] = static_cast<float>(p.x);
    y[i] = static_cast<float>(p.y);
    heading[i] = toBinaryAngle(p.theta);
    weight[i] = w;
  }
  hyselam::Pose2 pose(std::size_t i) const { return {x[i], y[i], toRadians(heading[i])}; }
};

/// n particles spread evenly over the free cells with random headings, equal weights; in the order
/// of the cells, so that neighbours in memory are neighbours on the map.
/// @throws hyselam::InputError if the map has no free cell.
Particles uniformParticles(const FsdMap& map, std::size_t n, std::uint64_t seed);

/// n particles around a pose of the grid's frame; standard deviations [m, m, rad].
Particles gaussianParticles(const hyselam::Pose2& mean, const hyselam::Pose2& stddev, std::size_t n,
                            std::uint64_t seed);

/// Effective sample size (sum w)^2 / sum w^2; 0 if all weights are 0.
double effectiveSampleSize(const Particles& particles);

/// Low-variance (systematic) resampling: each particle is copied floor or ceil of n times its share
/// of the weight; one random offset in [0, 1). Keeps the order; weights become 1. With all weights
/// 0 (or not finite), all particles have equal weight.
/// @param out receives n particles; may not be `in`.
void resampleSystematic(const Particles& in, std::size_t n, double offset, Particles& out);

/// How many particles keep the Kullback-Leibler distance to the true posterior below `error` with
/// the quantile `z` (Fox 2003), for k occupied bins.
std::size_t kldSampleSize(std::size_t bins, double error, double z);

/// Number of bins (`cell` [m] x `cell` x `angle` [rad]) that hold a particle with a share of the
/// weight of at least a tenth of the average.
std::size_t occupiedBins(const Particles& particles, double cell, double angle);

}  // namespace fsd_localization

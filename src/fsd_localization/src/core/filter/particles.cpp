#include "fsd_localization/filter/particles.hpp"

#include <algorithm>
#include <cmath>

#include "fsd_localization/filter/noise.hpp"
#include "hyselam_common/errors.hpp"
#include "pose_bins.hpp"

namespace fsd_localization {

Particles uniformParticles(const FsdMap& map, std::size_t n, std::uint64_t seed) {
  const auto& cells = map.freeCells();
  if (cells.empty()) throw hyselam::InputError("map", "", "has no free cell to put particles on");
  const auto width = static_cast<std::uint32_t>(map.geometry().width);
  const double res = map.geometry().resolution;
  const std::uint64_t stream = hyselam::splitmix64(seed);
  Particles p;
  p.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double u =
        (static_cast<double>(i) + toUnit(hashAt(stream, 4 * i))) / static_cast<double>(n);
    const std::uint32_t c = cells[static_cast<std::size_t>(u * static_cast<double>(cells.size()))];
    const std::uint32_t column = c % width, row = c / width;
    p.x[i] = static_cast<float>((column + toUnit(hashAt(stream, 4 * i + 1))) * res);
    p.y[i] = static_cast<float>((row + toUnit(hashAt(stream, 4 * i + 2))) * res);
    p.heading[i] = static_cast<BinaryAngle>(hashAt(stream, 4 * i + 3) >> 32);
    p.weight[i] = 1.0F;
  }
  return p;
}

Particles gaussianParticles(const hyselam::Pose2& mean, const hyselam::Pose2& stddev, std::size_t n,
                            std::uint64_t seed) {
  const NoiseTable noise;
  const std::uint64_t stream = hyselam::splitmix64(seed);
  Particles p;
  p.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    float a, b, c;
    noise.gaussians(hashAt(stream, i), a, b, c);
    p.set(i, {mean.x + a * stddev.x, mean.y + b * stddev.y, mean.theta + c * stddev.theta}, 1.0F);
  }
  return p;
}

double effectiveSampleSize(const Particles& particles) {
  double sum = 0.0, squares = 0.0;
  for (float w : particles.weight) {
    sum += w;
    squares += static_cast<double>(w) * w;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

void resampleSystematic(const Particles& in, std::size_t n, double offset, Particles& out) {
  out.resize(n);
  std::fill(out.weight.begin(), out.weight.end(), 1.0F);
  if (in.size() == 0 || n == 0) return;
  double sum = 0.0;
  for (float w : in.weight) sum += w;
  const bool informative = sum > 0.0 && std::isfinite(sum);
  const double scale = informative ? static_cast<double>(n) / sum
                                   : static_cast<double>(n) / static_cast<double>(in.size());
  // Copy number k of n is drawn from the particle whose stretch of the weights holds k + offset.
  double reached = -offset;
  std::size_t made = 0;
  for (std::size_t i = 0; i < in.size() && made < n; ++i) {
    reached += (informative ? in.weight[i] : 1.0) * scale;
    while (made < n && static_cast<double>(made) < reached) {
      out.x[made] = in.x[i];
      out.y[made] = in.y[i];
      out.heading[made] = in.heading[i];
      ++made;
    }
  }
  for (std::size_t last = in.size() - 1; made < n; ++made) {  // what rounding left over
    out.x[made] = in.x[last];
    out.y[made] = in.y[last];
    out.heading[made] = in.heading[last];
  }
}

std::size_t kldSampleSize(std::size_t bins, double error, double z) {
  if (bins < 2) return 1;
  const double k = static_cast<double>(bins - 1);
  const double b = 2.0 / (9.0 * k);
  const double x = 1.0 - b + std::sqrt(b) * z;
  return static_cast<std::size_t>(std::ceil(k / (2.0 * error) * x * x * x));
}

std::size_t occupiedBins(const Particles& p, double cell, double angle) {
  double sum = 0.0;
  for (float w : p.weight) sum += w;
  const double threshold = 0.1 * sum / std::max<double>(1.0, static_cast<double>(p.size()));
  PoseBins bins(cell, angle, p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.weight[i] >= threshold) bins.add(p, i);
  }
  return bins.bins.size();
}

}  // namespace fsd_localization

#include "support_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "hyselam_common/rng.hpp"

namespace hyselam_objects {
namespace {

/// How well a plane can be a support by its normal: 0 not at all, 1 best.
float levelness(const Eigen::Vector3f& normal, const std::optional<Eigen::Vector3f>& up,
                const SegmentParams& params) {
  if (up) {
    return normal.dot(*up) > static_cast<float>(std::cos(params.max_support_tilt)) ? 1.0f : 0.0f;
  }
  constexpr float kLeast = 0.1f;  // seen from right above
  constexpr float kUpsideDown = 0.5f;
  return std::max(kLeast, normal.y() < 0.0f ? -normal.y() : kUpsideDown * normal.y());
}

/// Least squares over the inliers.
Plane refinePlane(Plane best, const SurfaceGrid& grid, const std::vector<std::size_t>& valid) {
  for (int round = 0; round < 3; ++round) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    double n = 0.0;
    for (const std::size_t j : valid) {
      const float tolerance = 0.004f + 2.0f * grid.sigma(j);
      if (std::abs(best.heightOf(grid.point(j))) > tolerance ||
          grid.normal(j).dot(best.normal) < 0.95f) {
        continue;
      }
      const Eigen::Vector3d p = grid.point(j).cast<double>();
      mean += p;
      moments += p * p.transpose();
      n += 1.0;
    }
    if (n < 50.0) break;
    mean /= n;
    const Eigen::Matrix3d spread = moments / n - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    Eigen::Vector3f normal = axes.eigenvectors().col(0).cast<float>();
    if (normal.dot(mean.cast<float>()) > 0.0f) normal = -normal;
    best = {normal, normal.dot(mean.cast<float>())};
  }
  return best;
}

}  // namespace

std::optional<Plane> findSupportPlane(const SurfaceGrid& grid, const SegmentParams& params,
                                      const std::optional<Eigen::Vector3f>& up) {
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.hasNormal(i)) valid.push_back(i);
  }
  if (valid.size() < 100) return std::nullopt;
  hyselam::Rng rng(params.seed);
  const std::size_t step = std::max<std::size_t>(1, valid.size() / 4000);
  Plane best;
  std::size_t most = 0;       // inliers ...
  float most_support = 0.0f;  // ... by how well they can be a support
  for (int trial = 0; trial < 120; ++trial) {
    const std::size_t i = valid[rng.below(static_cast<std::uint32_t>(valid.size()))];
    if (grid.variation(i) > 0.01f) continue;
    const Plane plane{grid.normal(i), grid.normal(i).dot(grid.point(i))};
    const float level = levelness(plane.normal, up, params);
    if (level <= 0.0f) continue;
    std::size_t inliers = 0;
    for (std::size_t k = 0; k < valid.size(); k += step) {
      const std::size_t j = valid[k];
      const float tolerance = 0.008f + 2.0f * grid.sigma(j);
      inliers += std::abs(plane.heightOf(grid.point(j))) < tolerance &&
                 grid.normal(j).dot(plane.normal) > 0.95f;
    }
    if (const float support = level * static_cast<float>(inliers); support > most_support) {
      most_support = support;
      most = inliers;
      best = plane;
    }
  }
  if (most * step < 100) return std::nullopt;
  return refinePlane(best, grid, valid);
}

std::vector<bool> pixelsAbove(const SurfaceGrid& grid, const Plane& support,
                              const SegmentParams& params) {
  std::vector<bool> out(grid.size(), false);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!grid.isValid(i)) continue;
    const float height = support.heightOf(grid.point(i));
    out[i] = height > static_cast<float>(params.support_distance) + 1.5f * grid.sigma(i) &&
             height < static_cast<float>(params.max_object_height);
  }
  return out;
}

}  // namespace hyselam_objects

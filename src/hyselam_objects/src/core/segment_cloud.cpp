#include "hyselam_objects/segment_cloud.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "join_patches.hpp"
#include "surface_grid.hpp"

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;

/// The plane that most of the surface lies in.
std::optional<Plane> findSupport(const SurfaceGrid& grid, const SegmentParams& params) {
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.hasNormal(i)) valid.push_back(i);
  }
  if (valid.size() < 100) return std::nullopt;
  hyselam::Rng rng(params.seed);
  const std::size_t step = std::max<std::size_t>(1, valid.size() / 4000);
  Plane best;
  std::size_t most = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const std::size_t i = valid[rng.below(static_cast<std::uint32_t>(valid.size()))];
    if (grid.variation(i) > 0.01f) continue;
    const Plane plane{grid.normal(i), grid.normal(i).dot(grid.point(i))};
    std::size_t inliers = 0;
    for (std::size_t k = 0; k < valid.size(); k += step) {
      const std::size_t j = valid[k];
      const float tolerance = 0.008f + 2.0f * grid.sigma(j);
      inliers += std::abs(plane.heightOf(grid.point(j))) < tolerance &&
                 grid.normal(j).dot(plane.normal) > 0.95f;
    }
    if (inliers > most) {
      most = inliers;
      best = plane;
    }
  }
  if (most * step < 100) return std::nullopt;
  for (int round = 0; round < 3; ++round) {  // least squares over the inliers
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

/// What stands on the support, not higher than the tallest object.
std::vector<bool> above(const SurfaceGrid& grid, const Plane& support,
                        const SegmentParams& params) {
  std::vector<bool> out(grid.size(), false);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!grid.isValid(i)) continue;
    const float height = support.heightOf(grid.point(i));
    out[i] = height > static_cast<float>(params.support_distance) + 1.5f * grid.sigma(i) &&
             height < static_cast<float>(params.tallest);
  }
  return out;
}

}  // namespace

void checkCloud(const OrganisedCloud& cloud) {
  using hyselam::InputError;
  const auto size = static_cast<std::size_t>(std::max(0, cloud.width)) *
                    static_cast<std::size_t>(std::max(0, cloud.height));
  if (cloud.width < 0 || cloud.height < 0 || cloud.points.size() != size ||
      (!cloud.colours.empty() && cloud.colours.size() != size)) {
    throw InputError("cloud", "", "has not as many points as its width and height say");
  }
  if (size > 50000000) throw InputError("cloud", "", "has more than 50 million points");
}

void checkSegment(const OrganisedCloud& cloud, const SegmentParams& p) {
  using hyselam::ParameterError;
  checkCloud(cloud);
  if (p.reduce < 1 || p.reduce > 8) throw ParameterError("reduce", p.reduce, "1 .. 8");
  if (p.normal_window < 1 || p.normal_window > 20) {
    throw ParameterError("normal_window", p.normal_window, "1 .. 20");
  }
  for (const auto& [name, value] : {std::pair<const char*, double>{"noise_floor", p.noise_floor},
                                    {"noise_growth", p.noise_growth},
                                    {"smooth_angle", p.smooth_angle},
                                    {"flat", p.flat},
                                    {"support_distance", p.support_distance},
                                    {"tallest", p.tallest},
                                    {"convex_share", p.convex_share},
                                    {"concave_tolerance", p.concave_tolerance},
                                    {"step", p.step},
                                    {"meeting_share", p.meeting_share},
                                    {"border_share", p.border_share},
                                    {"hollow", p.hollow},
                                    {"splinter_gap", p.splinter_gap},
                                    {"hollow_share", p.hollow_share},
                                    {"bridge_length", p.bridge_length},
                                    {"bridge_angle", p.bridge_angle},
                                    {"bridge_distance", p.bridge_distance}}) {
    if (!(value >= 0.0 && value <= 10.0)) throw ParameterError(name, value, "0 .. 10");
  }
  if (p.splinter < 0) throw ParameterError("splinter", p.splinter, ">= 0");
  if (p.smallest < 1) throw ParameterError("smallest", p.smallest, ">= 1");
}

Segmentation segmentCloud(const OrganisedCloud& cloud, const SegmentParams& params) {
  checkSegment(cloud, params);
  Segmentation out;
  out.labels.assign(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.isValid(i)) out.labels[i] = 1;
  }
  const SurfaceGrid grid(cloud, params);
  out.support = findSupport(grid, params);
  if (!out.support) return out;
  const std::vector<bool> marked = above(grid, *out.support, params);
  const Patches patches(grid, marked, params);
  const std::vector<int> objects = joinPatches(grid, patches, params);

  for (int y = 0; y < cloud.height; ++y) {
    for (int x = 0; x < cloud.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(cloud.width) +
                     static_cast<std::size_t>(x);
      if (out.labels[i] == 0) continue;
      // Of the reduced pixels around: the one whose depth is nearest.
      float least = std::numeric_limits<float>::infinity();
      int object = kNone;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int gx = x / params.reduce + dx, gy = y / params.reduce + dy;
          if (gx < 0 || gy < 0 || gx >= grid.width() || gy >= grid.height()) continue;
          const std::size_t j = grid.index(gx, gy);
          if (!grid.isValid(j)) continue;
          const float off = (grid.point(j) - cloud.points[i]).squaredNorm();
          if (off < least) {
            least = off;
            object = objects[j];
          }
        }
      }
      if (object == kNone) continue;
      out.labels[i] = static_cast<std::uint32_t>(object + 2);
      out.objects = std::max(out.objects, static_cast<std::uint32_t>(object + 1));
    }
  }
  return out;
}

}  // namespace hyselam_objects

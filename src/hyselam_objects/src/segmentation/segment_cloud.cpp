#include "hyselam_objects/segmentation/segment_cloud.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "merge_patches.hpp"
#include "surface_grid.hpp"

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;

/// The plane with most inliers (RANSAC), refined.
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

/// Pixels above the support, not higher than objects are.
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

}  // namespace

void checkCloud(const OrganizedCloud& cloud) {
  using hyselam::InputError;
  const auto size = static_cast<std::size_t>(std::max(0, cloud.width)) *
                    static_cast<std::size_t>(std::max(0, cloud.height));
  if (cloud.width < 0 || cloud.height < 0 || cloud.points.size() != size ||
      (!cloud.colors.empty() && cloud.colors.size() != size)) {
    throw InputError("cloud", "", "has not as many points as its width and height say");
  }
  if (size > 50000000) throw InputError("cloud", "", "has more than 50 million points");
}

void SegmentParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  const Range share = Range::between(0.0, 10.0), length = share, angle = share;
  visit("downsampling", downsampling, Range::between(1, 8), "", "of rows and columns");
  visit("noise_floor", noise_floor, length, "m", "standard deviation of a depth at 0.4 m");
  visit("noise_growth", noise_growth, share, "1/m", "its growth with (depth - 0.4 m)^2");
  visit("normal_window", normal_window, Range::between(1, 20), "pixel",
        "half side of the window of a normal, in reduced pixels");
  visit("max_smooth_angle", max_smooth_angle, angle, "rad",
        "between the normals of neighbors in one patch");
  visit("max_surface_variation", max_surface_variation, share, "", "where patches grow");
  visit("support_distance", support_distance, length, "m",
        "nearer points belong to the support plane; noise is added");
  visit("max_object_height", max_object_height, length, "m", "above the support plane");
  visit("min_convex_ratio", min_convex_ratio, share, "",
        "share of the contact of two patches that must be convex");
  visit("concavity_tolerance", concavity_tolerance, angle, "rad",
        "a smaller concave angle counts as flat");
  visit("max_step", max_step, length, "m", "surfaces in contact miss each other by less");
  visit("min_contact_ratio", min_contact_ratio, share, "",
        "share of the border of two patches that must be in contact");
  visit("min_border_ratio", min_border_ratio, share, "",
        "length of the convex contact over the root of the smaller patch's size");
  visit("min_hollow_angle", min_hollow_angle, angle, "rad",
        "concave turn of the normals inside a hollow object");
  visit("min_hollow_ratio", min_hollow_ratio, share, "",
        "share of the lower edge of the inside that the outside hides");
  visit("max_occlusion_length", max_occlusion_length, length, "m",
        "distance between parts of one surface behind an occluder");
  visit("max_occlusion_angle", max_occlusion_angle, angle, "rad",
        "between the normals of those parts");
  visit("max_occlusion_offset", max_occlusion_offset, length, "m",
        "by which those parts miss each other");
  visit("min_object_pixels", min_object_pixels, Range::atLeast(1), "pixel",
        "reduced pixels of an object");
  visit("max_fragment_pixels", max_fragment_pixels, Range::atLeast(0), "pixel",
        "smaller fragments join the object around them");
  visit("max_fragment_gap", max_fragment_gap, length, "m",
        "distance between a fragment and the object that it joins");
}

void SegmentParams::validate() const {
  hyselam::checkParameters(*this);
}

CloudSegmentation segmentCloud(const OrganizedCloud& cloud, const SegmentParams& params) {
  checkCloud(cloud);
  params.validate();
  CloudSegmentation out;
  out.labels.assign(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.isValid(i)) out.labels[i] = 1;
  }
  const SurfaceGrid grid(cloud, params);
  out.support = findSupport(grid, params);
  if (!out.support) return out;
  const std::vector<bool> marked = pixelsAbove(grid, *out.support, params);
  const Patches patches(grid, marked, params);
  const std::vector<int> objects = mergePatches(grid, patches, params);

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
          const int gx = x / params.downsampling + dx, gy = y / params.downsampling + dy;
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

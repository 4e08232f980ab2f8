#include "surface_grid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hyselam_objects {
namespace {

/// As SurfaceGrid::color().
Point opponentColor(std::uint32_t rgb) {
  const auto channel = [rgb](int shift) {
    return static_cast<float>(rgb >> shift & 255u) / 255.0f;
  };
  const float r = channel(16), g = channel(8), b = channel(0);
  return {(r + g + b) / 3.0f, 0.5f * (r - g), 0.25f * (r + g - 2.0f * b)};
}

}  // namespace

SurfaceGrid::SurfaceGrid(const OrganizedCloud& cloud, const SegmentParams& params)
    : width_((cloud.width + params.downsampling - 1) / params.downsampling),
      height_((cloud.height + params.downsampling - 1) / params.downsampling) {
  downsample(cloud, params);
  computeNormals(params.normal_window);
}

bool SurfaceGrid::areConnected(std::size_t i, std::size_t j) const {
  if (!isValid(i) || !isValid(j)) return false;
  // A surface may recede by 4 pixels' widths per pixel (76 degrees).
  const float z = std::min(points_[i].z(), points_[j].z());
  const float pixel = std::max(0.001f, (points_[i] - points_[j]).head<2>().norm());
  return std::abs(points_[i].z() - points_[j].z()) < 4.0f * pixel + 0.25f * 0.01f * z + sigma_[i];
}

void SurfaceGrid::downsample(const OrganizedCloud& cloud, const SegmentParams& params) {
  points_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                 Point::Zero());
  sigma_.assign(points_.size(), 0.0f);
  if (!cloud.colors.empty()) colors_.assign(points_.size(), Point::Zero());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      // The mean of what lies on the nearest surface.
      std::array<std::size_t, 64> seen{};
      std::size_t count = 0;
      float nearest = std::numeric_limits<float>::infinity();
      for (int v = y * params.downsampling;
           v < std::min((y + 1) * params.downsampling, cloud.height); ++v) {
        for (int u = x * params.downsampling;
             u < std::min((x + 1) * params.downsampling, cloud.width); ++u) {
          const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(cloud.width) +
                         static_cast<std::size_t>(u);
          if (!cloud.isValid(i) || cloud.points[i].z() <= 0.0f) continue;
          seen[count++] = i;
          nearest = std::min(nearest, cloud.points[i].z());
        }
      }
      if (count == 0) continue;
      Point sum = Point::Zero(), color = Point::Zero();
      float n = 0.0f;
      for (std::size_t k = 0; k < count; ++k) {
        if (cloud.points[seen[k]].z() > nearest * 1.02f) continue;
        sum += cloud.points[seen[k]];
        if (hasColors()) color += opponentColor(cloud.colors[seen[k]]);
        n += 1.0f;
      }
      points_[index(x, y)] = sum / n;
      if (hasColors()) colors_[index(x, y)] = color / n;
      const float far = std::max(0.0f, nearest - 0.4f);
      sigma_[index(x, y)] =
          std::max(1e-6f, static_cast<float>(params.noise_floor +
                                             params.noise_growth * static_cast<double>(far * far)));
    }
  }
}

void SurfaceGrid::computeNormals(int window) {
  normals_.assign(size(), Point::Zero());
  variation_.assign(size(), 1.0f);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = index(x, y);
      if (!isValid(i)) continue;
      const Point center = points_[i];
      const float jump = 0.012f * center.z() + 3.0f * sigma_[i];
      Point sum = Point::Zero();
      Eigen::Matrix3f moments = Eigen::Matrix3f::Zero();
      float n = 0.0f;
      for (int v = std::max(0, y - window); v <= std::min(height_ - 1, y + window); ++v) {
        for (int u = std::max(0, x - window); u <= std::min(width_ - 1, x + window); ++u) {
          const std::size_t j = index(u, v);
          if (!isValid(j)) continue;
          const Point p = points_[j] - center;
          if (std::abs(p.z()) > jump) continue;
          sum += p;
          moments.noalias() += p * p.transpose();
          n += 1.0f;
        }
      }
      if (n < 6.0f) continue;
      const Point mean = sum / n;
      const Eigen::Matrix3f spread = moments / n - mean * mean.transpose();
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
      axes.computeDirect(spread);
      const Eigen::Vector3f values = axes.eigenvalues();
      const float total = values.sum();
      if (!(total > 0.0f) || !(values(1) > 1e-12f)) continue;
      Point normal = axes.eigenvectors().col(0);
      if (normal.dot(center) > 0.0f) normal = -normal;
      if (!normal.allFinite()) continue;
      normals_[i] = normal;
      variation_[i] = std::clamp(values(0) / total, 0.0f, 0.34f);
    }
  }
}

}  // namespace hyselam_objects

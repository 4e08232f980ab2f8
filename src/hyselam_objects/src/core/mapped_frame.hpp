// A frame with its points and normals in the map's directions: what is level, what is upright.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hyselam_objects/detect_objects.hpp"
#include "surface_grid.hpp"

namespace hyselam_objects {

class MappedFrame {
 public:
  /// `cloud` must outlive this.
  MappedFrame(const OrganisedCloud& cloud, const Eigen::Isometry3d& camera_in_map,
              const DetectParams& params);

  const SurfaceGrid& grid() const { return grid_; }
  std::size_t size() const { return grid_.size(); }
  /// Where the camera is.
  const Eigen::Vector3f& eye() const { return eye_; }
  /// Of a valid pixel.
  const Eigen::Vector3f& point(std::size_t i) const { return points_[i]; }
  /// z of the normal; 0 without one, and for what is too far.
  float up(std::size_t i) const { return up_[i]; }
  /// Whether it is measured, and near enough to be looked at.
  bool isNear(std::size_t i) const {
    return grid_.isValid(i) && grid_.point(i).z() < static_cast<float>(range_);
  }

  /// What the pixels show of one thing. `trim`: share of the points that lie outside of the box on
  /// each side.
  DetectedObject describe(const std::vector<std::size_t>& pixels, double trim) const;

 private:
  std::uint32_t colourAt(int x, int y) const;

  const OrganisedCloud& cloud_;
  const int reduce_;
  const double range_;
  const SurfaceGrid grid_;
  const Eigen::Vector3f eye_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<float> up_;
};

}  // namespace hyselam_objects

// A frame with its points and normals in the frame of the map.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hyselam_objects/segmentation/detect_objects.hpp"
#include "surface_grid.hpp"

namespace hyselam_objects {

class MappedFrame {
 public:
  /// `cloud` must outlive this.
  MappedFrame(const OrganizedCloud& cloud, const Eigen::Isometry3d& camera_in_map,
              const DetectParams& params);

  const SurfaceGrid& grid() const { return grid_; }
  std::size_t size() const { return grid_.size(); }
  const Eigen::Vector3f& cameraPosition() const { return camera_position_; }
  /// Of a valid pixel.
  const Eigen::Vector3f& point(std::size_t i) const { return points_[i]; }
  /// z of the normal; 0 without one, and for pixels out of range.
  float normalZ(std::size_t i) const { return normal_z_[i]; }
  /// Whether it is measured and near enough.
  bool isInRange(std::size_t i) const {
    return grid_.isValid(i) && grid_.point(i).z() < static_cast<float>(max_range_);
  }

  /// Box and appearance of one object from its pixels. `trim`: share of the points that lie outside
  /// of the box on each side.
  DetectedObject objectOf(const std::vector<std::size_t>& pixels, double trim) const;

 private:
  std::uint32_t colorAt(int x, int y) const;

  const OrganizedCloud& cloud_;
  const int downsampling_;
  const double max_range_;
  const SurfaceGrid grid_;
  const Eigen::Vector3f camera_position_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<float> normal_z_;
};

}  // namespace hyselam_objects

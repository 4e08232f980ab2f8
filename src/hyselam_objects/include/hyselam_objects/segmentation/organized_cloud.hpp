// One frame of a color and depth camera: a point for each pixel.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hyselam_objects {

using Point = Eigen::Vector3f;

/// Row-major, `width * height` points in the camera's optical frame (x right, y down, z forward,
/// REP-103) [m]; pixels without a measurement have a z that is NaN.
struct OrganizedCloud {
  int width = 0;
  int height = 0;
  std::vector<Point> points;
  std::vector<std::uint32_t> colors;  ///< 0x00RRGGBB of each point; empty: not known

  std::size_t size() const { return points.size(); }
  bool isValid(std::size_t i) const { return points[i].allFinite(); }
};

}  // namespace hyselam_objects

// The plane that objects stand on, and the pixels above it.
#pragma once

#include <optional>
#include <vector>

#include "surface_grid.hpp"

namespace hyselam_objects {

/// The plane with most inliers (RANSAC), refined. With `up`, a vector of length 1, only planes that
/// face up. Without, a plane counts the more the more it faces up in the image, or else down (the
/// image may be upside down): walls face the camera.
std::optional<Plane> findSupportPlane(const SurfaceGrid& grid, const SegmentParams& params,
                                      const std::optional<Eigen::Vector3f>& up);

/// Pixels above the support, not higher than objects are.
std::vector<bool> pixelsAbove(const SurfaceGrid& grid, const Plane& support,
                              const SegmentParams& params);

}  // namespace hyselam_objects

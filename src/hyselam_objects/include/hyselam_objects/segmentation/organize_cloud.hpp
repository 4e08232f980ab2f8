// Rows and columns for points that have none, and the right way up for images that have not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hyselam_objects/segmentation/organized_cloud.hpp"

namespace hyselam_objects {

constexpr std::size_t kLeastPoints = 100;  ///< of an image that is made of them

/// Of a pinhole camera: a point is in column `focal_x * x / z + center_x`, in row
/// `focal_y * y / z + center_y` [pixel].
struct Intrinsics {
  double focal_x = 525.0, focal_y = 525.0, center_x = 319.5, center_y = 239.5;
  int width = 640, height = 480;
};

/// How the image of a cloud was turned; nothing of it is true of a camera's own cloud.
struct ImageTurn {
  bool behind = false;       ///< depth was negative: the points lay behind the camera
  bool mirrored = false;     ///< rows or columns ran against y or x, but not both
  bool upside_down = false;  ///< up was down in the image
};

/// A cloud with rows and columns that run with y and x, and where each point of the original is.
struct OrganizedView {
  OrganizedCloud cloud;
  Intrinsics camera;                   ///< given or estimated
  std::vector<std::int32_t> pixel_of;  ///< of each point of the original; -1: in none
};

/// Points as one view from the origin: by the intrinsics given, by the columns and rows that the
/// cloud has or, where the points of one row still lie in those of a camera, by those; else by as
/// many pixels as there are points.
/// Of the points in a pixel the nearest is kept; others have it too if they are as near.
/// Nothing if the points were not seen from the origin (many hide others, or half of them lie
/// behind or beside it), or are fewer than kLeastPoints.
/// @throws hyselam::InputError for intrinsics that are not finite, not positive, or of an image
///         larger than 50 million pixels.
std::optional<OrganizedView> organizeCloud(const OrganizedCloud& cloud,
                                           const std::optional<Intrinsics>& intrinsics = {});

/// Whether most depths are negative: of a camera that looks along -z and has y up.
bool liesBehind(const OrganizedCloud& cloud);

/// By half a turn about x, which brings such a cloud in front of the camera.
void turnToFront(OrganizedCloud& cloud);

/// Points that are numbers, and not the origin itself.
std::size_t usablePoints(const OrganizedCloud& cloud);

}  // namespace hyselam_objects

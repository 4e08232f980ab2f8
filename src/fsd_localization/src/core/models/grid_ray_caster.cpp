#include "fsd_localization/models/grid_ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace fsd_localization {

GridRayCaster::GridRayCaster(const hyselam::OccupancyGrid& map,
                             const OccupancyThresholds& thresholds)
    : width_(map.geometry.width),
      height_(map.geometry.height),
      resolution_(map.geometry.resolution) {
  cv::Mat open(height_, width_, CV_8U), distance;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      open.at<std::uint8_t>(y, x) = thresholds.isOccupied(map.at({x, y})) ? 0 : 1;
    }
  }
  cv::distanceTransform(open, distance, cv::DIST_C, 3);
  open_within_.resize(map.geometry.cellCount());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      open_within_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(std::min(255.0F, distance.at<float>(y, x)));
    }
  }
}

double GridRayCaster::range(double x, double y, double direction, double max_range) const {
  return rangeAlong(x, y, std::cos(direction), std::sin(direction), max_range);
}

double GridRayCaster::rangeAlong(double x, double y, double dx, double dy, double max_range) const {
  const double px = x / resolution_, py = y / resolution_, limit = max_range / resolution_;
  const double inv_x = 1.0 / dx, inv_y = 1.0 / dy;
  if (!(px >= 0.0 && py >= 0.0 && px < width_ && py < height_)) return max_range;
  int cx = static_cast<int>(px), cy = static_cast<int>(py);
  double t = 0.0;  // [cells] along the ray where it enters (cx, cy)
  while (t < limit && cx >= 0 && cy >= 0 && cx < width_ && cy < height_) {
    const int open = open_within_[static_cast<std::size_t>(cy) * static_cast<std::size_t>(width_) +
                                  static_cast<std::size_t>(cx)];
    if (open == 0) return t * resolution_;
    // The square of cells around this one that holds no obstacle is left at once; with open == 1 it
    // is this cell alone, and this is the plain step from cell to cell.
    const int margin = open - 1;
    const double tx = dx != 0.0 ? ((dx > 0.0 ? cx + margin + 1 : cx - margin) - px) * inv_x
                                : std::numeric_limits<double>::infinity();
    const double ty = dy != 0.0 ? ((dy > 0.0 ? cy + margin + 1 : cy - margin) - py) * inv_y
                                : std::numeric_limits<double>::infinity();
    if (tx < ty) {
      t = tx;
      const int from = cy;
      cx = dx > 0.0 ? cx + margin + 1 : cx - margin - 1;
      cy = std::clamp(static_cast<int>(std::floor(py + t * dy)), from - margin, from + margin);
    } else {
      t = ty;
      const int from = cx;
      cy = dy > 0.0 ? cy + margin + 1 : cy - margin - 1;
      cx = std::clamp(static_cast<int>(std::floor(px + t * dx)), from - margin, from + margin);
    }
  }
  return max_range;
}

}  // namespace fsd_localization

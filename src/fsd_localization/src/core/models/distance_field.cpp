#include "fsd_localization/models/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

namespace {

/// Distance of each pixel to the nearest 0 [m].
std::vector<float> distanceToZero(const cv::Mat& pixels, double resolution) {
  std::vector<float> metres(pixels.total());
  if (cv::countNonZero(pixels) == static_cast<int>(pixels.total())) {
    const double diagonal = std::hypot(pixels.cols, pixels.rows) * resolution;
    std::fill(metres.begin(), metres.end(), static_cast<float>(diagonal));
    return metres;
  }
  cv::Mat out(pixels.rows, pixels.cols, CV_32F, metres.data());
  cv::distanceTransform(pixels, out, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  out *= resolution;
  return metres;
}

}  // namespace

DistanceField distanceField(const hyselam::OccupancyGrid& map,
                            const OccupancyThresholds& thresholds) {
  const auto& g = map.geometry;
  if (g.width <= 0 || g.height <= 0 || map.cells.size() != g.cellCount()) {
    throw hyselam::InputError("map", "size", "cell count does not fit width x height, or no cells");
  }
  cv::Mat open(g.height, g.width, CV_8U);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      open.at<std::uint8_t>(y, x) = thresholds.isOccupied(map.at({x, y})) ? 0 : 1;
    }
  }
  return {g, distanceToZero(open, g.resolution), distanceToZero(1 - open, g.resolution)};
}

}  // namespace fsd_localization

#include "fsd_localization/distance_field.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

DistanceField distanceField(const hyselam::OccupancyGrid& map,
                            const OccupancyThresholds& thresholds) {
  const auto& g = map.geometry;
  if (g.width <= 0 || g.height <= 0 || map.cells.size() != g.cellCount())
    throw hyselam::InputError("map", "size", "cell count does not fit width x height, or no cells");
  cv::Mat open(g.height, g.width, CV_8U), pixels;
  bool any_obstacle = false;
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      const bool obstacle = map.at({x, y}) >= thresholds.occupied_from;
      any_obstacle |= obstacle;
      open.at<std::uint8_t>(y, x) = obstacle ? 0 : 1;
    }
  DistanceField field;
  field.geometry = g;
  const double diagonal = std::hypot(g.width, g.height);
  if (!any_obstacle) {
    field.metres.assign(g.cellCount(), static_cast<float>(diagonal * g.resolution));
    return field;
  }
  cv::distanceTransform(open, pixels, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  field.metres.reserve(g.cellCount());
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x)
      field.metres.push_back(static_cast<float>(pixels.at<float>(y, x) * g.resolution));
  return field;
}

}  // namespace fsd_localization

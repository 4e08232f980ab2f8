#include "camera_from_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

double median(std::vector<double> all) {
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

}  // namespace

PinholeCamera cameraFromCloud(const OrganizedCloud& cloud) {
  constexpr std::size_t kStep = 17, kMinPoints = 20;  // points
  PinholeCamera camera;
  camera.cx = 0.5 * cloud.width - 0.5;
  camera.cy = 0.5 * cloud.height - 0.5;
  std::vector<double> across, down;  // focal lengths
  for (std::size_t i = 0; i < cloud.size(); i += kStep) {
    const Point& p = cloud.points[i];
    if (!cloud.isValid(i)) continue;
    const auto width = static_cast<std::size_t>(cloud.width);
    const std::size_t row = i / width, column = i % width;
    const double u = static_cast<double>(column) - camera.cx;
    const double v = static_cast<double>(row) - camera.cy;
    if (std::abs(p.x()) > 0.05f) across.push_back(u * p.z() / p.x());
    if (std::abs(p.y()) > 0.05f) down.push_back(v * p.z() / p.y());
  }
  if (across.size() < kMinPoints || down.size() < kMinPoints) {
    throw hyselam::InputError("points", "", "hardly a point is valid");
  }
  camera.focal_length = median(across);
  const double other = median(down);
  if (!(camera.focal_length > 0.0 && other > 0.0 && std::isfinite(camera.focal_length))) {
    throw hyselam::InputError("points", "",
                              "they are not in the order of a camera's picture: x does not grow "
                              "to the right, or y not downwards");
  }
  return camera;
}

}  // namespace hyselam_objects

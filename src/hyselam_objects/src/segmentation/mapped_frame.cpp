#include "mapped_frame.hpp"

#include <algorithm>
#include <array>

#include "hyselam_objects/recognition/object_descriptor.hpp"

namespace hyselam_objects {

MappedFrame::MappedFrame(const OrganizedCloud& cloud, const Eigen::Isometry3d& camera_in_map,
                         const DetectParams& params)
    : cloud_(cloud),
      downsampling_(params.segmentation.downsampling),
      max_range_(params.max_range),
      grid_(cloud, params.segmentation),
      camera_position_(camera_in_map.translation().cast<float>()) {
  const Eigen::Isometry3f pose = camera_in_map.cast<float>();
  points_.resize(grid_.size());
  normal_z_.assign(grid_.size(), 0.0f);
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (!grid_.isValid(i)) continue;
    points_[i] = pose * grid_.point(i);
    if (isInRange(i) && grid_.hasNormal(i)) normal_z_[i] = (pose.linear() * grid_.normal(i)).z();
  }
}

DetectedObject MappedFrame::objectOf(const std::vector<std::size_t>& pixels, double trim) const {
  DetectedObject object;
  object.points = pixels.size();
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> colors;
  std::array<std::vector<float>, 3> axes;
  for (const std::size_t i : pixels) {
    const auto x = static_cast<int>(i % static_cast<std::size_t>(grid_.width()));
    const auto y = static_cast<int>(i / static_cast<std::size_t>(grid_.width()));
    object.partial =
        object.partial || x < 2 || y < 2 || x + 2 >= grid_.width() || y + 2 >= grid_.height();
    points.push_back(points_[i]);
    for (std::size_t k = 0; k < 3; ++k) axes[k].push_back(points_[i][static_cast<int>(k)]);
    if (!cloud_.colors.empty()) colors.push_back(colorAt(x, y));
  }
  std::array<double, 3> low{}, high{};
  for (std::size_t k = 0; k < 3 && !pixels.empty(); ++k) {
    const auto n = static_cast<double>(axes[k].size() - 1);
    const auto at = [&](double share) {
      const auto place = axes[k].begin() + static_cast<std::ptrdiff_t>(share * n);
      std::nth_element(axes[k].begin(), place, axes[k].end());
      return static_cast<double>(*place);
    };
    low[k] = at(trim);
    high[k] = at(1.0 - trim);
  }
  object.low = {low[0], low[1], low[2]};
  object.high = {high[0], high[1], high[2]};
  std::vector<Eigen::Vector2f> ground;
  ground.reserve(points.size());
  for (const Eigen::Vector3f& p : points) ground.push_back(p.head<2>());
  object.outline = outlineOf(ground, trim);
  object.descriptor = describeView(points, colors);
  object.color = colorName(colors);
  return object;
}

std::uint32_t MappedFrame::colorAt(int x, int y) const {
  const int fx = std::min(x * downsampling_ + downsampling_ / 2, cloud_.width - 1);
  const int fy = std::min(y * downsampling_ + downsampling_ / 2, cloud_.height - 1);
  return cloud_.colors[static_cast<std::size_t>(fy) * static_cast<std::size_t>(cloud_.width) +
                       static_cast<std::size_t>(fx)];
}

}  // namespace hyselam_objects

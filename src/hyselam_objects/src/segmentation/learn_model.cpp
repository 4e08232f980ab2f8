#include "hyselam_objects/segmentation/learn_model.hpp"

#include <algorithm>
#include <string>

#include "hyselam_common/errors.hpp"

namespace hyselam_objects {

SurfaceModel learnModel(const std::vector<PlacedView>& views, const SegmentParams& params) {
  if (views.empty()) throw hyselam::InputError("model", "", "needs a view of it");
  const bool with_colors = std::all_of(views.begin(), views.end(), [](const PlacedView& view) {
    return !view.cloud.colors.empty();
  });
  SurfaceModel out;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PlacedView& view = views[i];
    const Eigen::Vector3f up = view.camera.linear().transpose() * Eigen::Vector3f::UnitZ();
    const CloudSegmentation found = segmentCloud(view.cloud, params, up);
    if (found.objects == 0) {
      throw hyselam::InputError("view " + std::to_string(i + 1), "",
                                "shows nothing that stands on a level surface");
    }
    for (std::size_t p = 0; p < view.cloud.size(); ++p) {
      if (found.labels[p] < 2) continue;
      out.cloud.points.push_back(view.camera * view.cloud.points[p]);
      out.seen_from.emplace_back(view.camera.translation());
      if (with_colors) out.cloud.colors.push_back(view.cloud.colors[p]);
    }
  }
  out.cloud.width = static_cast<int>(out.cloud.size());
  out.cloud.height = 1;
  return out;
}

}  // namespace hyselam_objects

#include "wall_cells.hpp"

#include <cmath>

namespace hyselam_objects {

WallCells::WallCells(const MappedFrame& frame, double max_object_height) {
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!frame.isInRange(i) || std::abs(frame.normalZ(i)) > 0.5f ||
        frame.point(i).z() < max_object_height)
      continue;
    const auto [x, y] = cellOf(frame.point(i));
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) cells_.insert({x + dx, y + dy});
    }
  }
}

WallCells::Cell WallCells::cellOf(const Eigen::Vector3f& p) {
  constexpr float kCell = 0.08f;  // [m]
  return {static_cast<int>(std::floor(p.x() / kCell)), static_cast<int>(std::floor(p.y() / kCell))};
}

}  // namespace hyselam_objects

#include "wall_cells.hpp"

#include <cmath>

namespace hyselam_objects {

WallCells::WallCells(const MappedFrame& frame, double tallest) {
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!frame.isNear(i) || std::abs(frame.up(i)) > 0.5f || frame.point(i).z() < tallest) continue;
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

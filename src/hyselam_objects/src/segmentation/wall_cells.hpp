// Cells of the plane with an upright surface that is taller than objects are: what stands there is
// a part of it. Otherwise the walls of a room would be taken for the inside of a bowl, and an
// object before them for its outside.
#pragma once

#include <set>
#include <utility>

#include "mapped_frame.hpp"

namespace hyselam_objects {

class WallCells {
 public:
  /// `max_object_height` [m].
  WallCells(const MappedFrame& frame, double max_object_height);

  bool contains(const Eigen::Vector3f& p) const { return cells_.count(cellOf(p)) != 0; }

 private:
  using Cell = std::pair<int, int>;
  static Cell cellOf(const Eigen::Vector3f& p);

  std::set<Cell> cells_;
};

}  // namespace hyselam_objects

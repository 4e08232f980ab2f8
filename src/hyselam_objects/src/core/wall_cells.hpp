// Where something upright is taller than things are: what stands there in the plane is a part of
// it. Else the walls of a room would be the inside of a bowl, and a thing before them its outside.
#pragma once

#include <set>
#include <utility>

#include "mapped_frame.hpp"

namespace hyselam_objects {

class WallCells {
 public:
  WallCells(const MappedFrame& frame, double tallest);

  bool contains(const Eigen::Vector3f& p) const { return cells_.count(cellOf(p)) != 0; }

 private:
  using Cell = std::pair<int, int>;
  static Cell cellOf(const Eigen::Vector3f& p);

  std::set<Cell> cells_;
};

}  // namespace hyselam_objects

// Critical points of the Voronoi diagram (Thrun 1998): where a passage is narrowest.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_gr2to/thesis/distance_map.hpp"

namespace hyselam_topo {

/// The critical line leads from `basis_a` by the point to `basis_b`.
struct CriticalPoint {
  hyselam::Cell at;
  double clearance = 0.0;  ///< [cells]
  hyselam::Cell basis_a;   ///< the obstacles that are nearest to the point, on both sides of it
  hyselam::Cell basis_b;
};

/// Cells of the diagram that have the least clearance of all diagram cells within `radius` [cells],
/// where it is more than half a cell larger within the radius. Neighbouring ones count as one, at
/// their middle; ends of lines do not count. In the order of rows.
std::vector<CriticalPoint> findCriticalPoints(const DistanceMap& distances,
                                              const cv::Mat& voronoi_lines, double radius);

}  // namespace hyselam_topo

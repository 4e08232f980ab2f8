// Circles along the Voronoi diagram that stand for places, and their connections (dos Santos 2014,
// section 4.2, fourth stage, Eq. 4.3).
#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "hyselam_gr2to/thesis/distance_map.hpp"

namespace hyselam_topo {

struct Circle {
  hyselam::Cell centre;  ///< on the diagram
  double radius = 0.0;   ///< its clearance [cells]
};

/// Goes along the cells of the diagram in the order of rows. A circle that overlaps none of the
/// stored ones is stored; one that is larger than all that it overlaps takes their place; any other
/// is dropped.
std::vector<Circle> packCircles(const DistanceMap& distances, const cv::Mat& voronoi_lines);

/// Of two circles nearer than sqrt(2) times their radii together the smaller goes, unless the
/// distance map half way between them is narrower than it (Eq. 4.3 as its figure shows it).
std::vector<Circle> dropCoveredCircles(std::vector<Circle> circles, const DistanceMap& distances);

/// Pairs (i, j), i < j, of circles that are joined by the diagram without another circle in
/// between: each cell of the diagram in a circle belongs to it, the others to the circle they are
/// nearest to along the diagram. Sorted.
std::vector<std::pair<std::size_t, std::size_t>> connectCircles(const std::vector<Circle>& circles,
                                                                const cv::Mat& voronoi_lines);

}  // namespace hyselam_topo

// Where a door may be, by the distance map alone (dos Santos 2014, section 4.2, second stage).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_gr2to/thesis/distance_map.hpp"

namespace hyselam_topo {

/// Cells whose distance to the nearest obstacle lies strictly between `min_radius` and `max_radius`
/// [cells] and that are a saddle: of eight distances sampled around them on a circle of
/// `min_radius` (Eq. 4.2) two that lie opposite, three or four steps of 45 degrees apart, are
/// larger than their own. In the order of rows.
std::vector<hyselam::Cell> doorCells(const DistanceMap& distances, double min_radius,
                                     double max_radius);

/// The central locations of cells that are close together: each cell, in order, joins the first
/// group whose mean is nearer than `radius` [cells], or begins one. Cell (x, y) is at (x, y).
std::vector<cv::Point2d> centralLocations(const std::vector<hyselam::Cell>& cells, double radius);

}  // namespace hyselam_topo

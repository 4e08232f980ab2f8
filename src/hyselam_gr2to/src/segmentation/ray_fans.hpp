// Fans of rays: what few rays saw through a window, a door or a gap in a wall. No wall stands at
// the sides of a ray, only what nobody has seen.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hyselam_topo {

/// Closes passages of `free` (CV_8U) that are narrow and mostly lie between unseen cells. Doors,
/// between two walls, stay.
/// `occupied`: CV_8U, where an obstacle was seen.
void closeRayFans(cv::Mat& free, const cv::Mat& occupied, double resolution);

/// Which labels of `labels` (CV_32S, 0 none, up to `count`) are no places but what few rays saw:
/// small, and with much more unseen around than walls. Never the largest. Index 0 is not used.
std::vector<char> findOutside(const cv::Mat& labels, int count, const cv::Mat& occupied,
                              double resolution);

}  // namespace hyselam_topo

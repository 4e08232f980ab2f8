// The distance of each cell of a mask to the nearest one that is 0.
#pragma once

#include <opencv2/core.hpp>

namespace hyselam_topo {

/// CV_32F [cells], bit for bit what cv::distanceTransform(mask, out, DIST_L2, DIST_MASK_5) gives of
/// a mask (CV_8U) that has a 0, up to 8191 cells from one: sums of straight (1), slanting (1.4) and
/// knight's (2.1969) steps. Cells that are 0 cost next to nothing, and most of the work on the
/// others is done in vectors (bench: ChamferDistance). The mask may be a part of a larger image.
cv::Mat chamferDistance(const cv::Mat& mask);

}  // namespace hyselam_topo

// What stands free in a place and is no wall.
#pragma once

#include <opencv2/core.hpp>

#include "free_space.hpp"

namespace hyselam_topo {

/// CV_8U, 255 in pieces up to 3 m across that touch no other, but for long thin ones: those are
/// pieces of wall between two openings, or screens.
cv::Mat findFurniture(const FreeSpace& space);

}  // namespace hyselam_topo

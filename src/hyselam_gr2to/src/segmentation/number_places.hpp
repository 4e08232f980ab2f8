// Last step of the segmentation: labels as they are given away.
#pragma once

#include <opencv2/core.hpp>

namespace hyselam_topo {

/// Each label (CV_16U) keeps its largest 4-connected piece; other pieces get the label of a
/// neighbour they touch, or none. Then the places are numbered 1 .. n in the order of their first
/// cells.
/// @return n.
int numberPlaces(cv::Mat& labels);

}  // namespace hyselam_topo

// Where the lines of a corridor or a room meet in the image (future work of 6.3.3, Fig. 6.16).
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace selovis {

/// Oblique edges of a small copy of the image vote for the cells of the middle half of the image
/// that they point at. Keeps its buffers between frames.
class VanishingPoint {
 public:
  /// In pixels of `image` (8-bit, BGR or grey); the image's middle where no point has more than its
  /// share of the votes.
  cv::Point2f find(const cv::Mat& image);

 private:
  cv::Mat small_, grey_, dx_, dy_;
  std::vector<float> votes_;
};

}  // namespace selovis

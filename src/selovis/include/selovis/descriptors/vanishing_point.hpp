// The vanishing point of a corridor or a room (dos Santos 2014, future work of 6.3.3, Fig. 6.16).
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace selovis {

/// Oblique edges of a small copy of the image vote for the cells of the middle half of the image
/// that their lines pass through. Keeps its buffers between frames.
class VanishingPoint {
 public:
  /// In pixels of `image` (8-bit, BGR or gray); its middle where no cell has clearly more votes
  /// than the mean. @throws hyselam::InputError for other images.
  cv::Point2f find(const cv::Mat& image);

 private:
  cv::Mat small_, gray_, dx_, dy_;
  std::vector<float> votes_;
};

}  // namespace selovis

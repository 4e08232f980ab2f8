// Images that tell nothing about a place: a bare wall, the dark (6.3.3, 6.4.4).
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

namespace selovis {

enum class DescriptiveKind { kNone, kSift, kCorners };

/// "none", "sift", "corners"; throws std::invalid_argument.
DescriptiveKind descriptiveKind(const std::string& name);

struct DescriptiveParams {
  DescriptiveKind kind = DescriptiveKind::kNone;
  /// Images with fewer features tell nothing; 0: 10 SIFT features (6.4.4), or 20 corners, which
  /// part the same images.
  int min_features = 0;
};

/// SIFT features counted as in the text, or FAST corners of the image at a quarter of its pixels,
/// which cost a few hundredths of it. Keeps its buffers between frames.
class DescriptiveFilter {
 public:
  /// Throws hyselam::ParameterError.
  explicit DescriptiveFilter(const DescriptiveParams& params);
  /// Number of features; 0 with kNone. Throws std::invalid_argument for images that are not 8-bit.
  int count(const cv::Mat& image);
  bool accepts(const cv::Mat& image);

 private:
  DescriptiveParams params_;
  cv::Ptr<cv::Feature2D> detector_;
  cv::Mat small_, grey_;
  std::vector<cv::KeyPoint> keypoints_;
};

}  // namespace selovis

// Rejects images that are not descriptive of any place, such as a bare wall or the dark (Maffei
// 2017, 6.3.3 and 6.4.4).
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace selovis {

enum class DescriptiveFilterKind { kNone, kSift, kCorners };

/// "none", "sift", "corners".
const char* toString(DescriptiveFilterKind kind);
/// @throws hyselam::InputError for any other text.
DescriptiveFilterKind descriptiveFilterKindFromString(const std::string& name);

struct DescriptiveFilterParams {
  DescriptiveFilterKind kind = DescriptiveFilterKind::kNone;
  /// Images with fewer features are rejected; 0: 10 SIFT features (6.4.4), or 20 corners, which
  /// separate the same images. 0 to 100000.
  int min_features = 0;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// Counts SIFT features as in the thesis, or FAST corners of the image scaled to 320 x 240 pixels,
/// which take a few hundredths of the time. Keeps its buffers between frames.
class DescriptiveFilter {
 public:
  /// @throws hyselam::ParameterError; hyselam::InputError for kSift before OpenCV 4.4.
  explicit DescriptiveFilter(const DescriptiveFilterParams& params);
  /// Number of features; 0 with kNone. @throws hyselam::InputError for images that are not 8-bit.
  int count(const cv::Mat& image);
  bool accepts(const cv::Mat& image);

 private:
  DescriptiveFilterParams params_;
  cv::Ptr<cv::Feature2D> detector_;
  cv::Mat small_, gray_;
  std::vector<cv::KeyPoint> keypoints_;
};

}  // namespace selovis

#include "selovis/descriptive.hpp"

#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "descriptor_parts.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr int kCornerContrast = 12;  // [grey levels] of FAST

}  // namespace

DescriptiveKind descriptiveKind(const std::string& name) {
  if (name == "none") return DescriptiveKind::kNone;
  if (name == "sift") return DescriptiveKind::kSift;
  if (name == "corners") return DescriptiveKind::kCorners;
  throw std::invalid_argument("no filter of images is called '" + name +
                              "': there are none, sift, corners");
}

DescriptiveFilter::DescriptiveFilter(const DescriptiveParams& params) : params_(params) {
  if (params.min_features < 0) {
    throw hyselam::ParameterError("min_features", params.min_features, "0 or more");
  }
  if (params_.min_features == 0) {
    params_.min_features = params.kind == DescriptiveKind::kSift ? 10 : 20;
  }
  if (params.kind == DescriptiveKind::kCorners) {
    detector_ = cv::FastFeatureDetector::create(kCornerContrast);
  } else if (params.kind == DescriptiveKind::kSift) {
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 4)
    detector_ = cv::SIFT::create();
#else
    throw std::invalid_argument("counting SIFT features needs OpenCV 4.4 or newer");
#endif
  }
}

int DescriptiveFilter::count(const cv::Mat& image) {
  if (!detector_) return 0;
  const cv::Mat& grey = greyOf(image, "the descriptive filter", grey_);
  if (params_.kind == DescriptiveKind::kCorners) {
    cv::resize(grey, small_, cv::Size(kWidth, kHeight), 0.0, 0.0, cv::INTER_AREA);
    detector_->detect(small_, keypoints_);
  } else {
    detector_->detect(grey, keypoints_);
  }
  return static_cast<int>(keypoints_.size());
}

bool DescriptiveFilter::accepts(const cv::Mat& image) {
  return params_.kind == DescriptiveKind::kNone || count(image) >= params_.min_features;
}

}  // namespace selovis

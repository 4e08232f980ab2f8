#include "selovis/descriptors/descriptive_filter.hpp"

#include <opencv2/imgproc.hpp>

#include "descriptor_terms.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr int kCornerContrast = 12;  // [gray levels] of FAST
constexpr int kMinSiftFeatures = 10, kMinCorners = 20;

}  // namespace

const char* toString(DescriptiveFilterKind kind) {
  switch (kind) {
    case DescriptiveFilterKind::kNone:
      return "none";
    case DescriptiveFilterKind::kSift:
      return "sift";
    case DescriptiveFilterKind::kCorners:
      break;
  }
  return "corners";
}

DescriptiveFilterKind descriptiveFilterKindFromString(const std::string& name) {
  for (const DescriptiveFilterKind kind :
       {DescriptiveFilterKind::kNone, DescriptiveFilterKind::kSift,
        DescriptiveFilterKind::kCorners}) {
    if (name == toString(kind)) return kind;
  }
  throw hyselam::InputError("filter of images '" + name + "'", "",
                            "is not known: there are none, sift, corners");
}

void DescriptiveFilterParams::describe(hyselam::ParameterVisitor& visit) {
  visit("descriptive_filter", kind,
        {{"none", DescriptiveFilterKind::kNone},
         {"sift", DescriptiveFilterKind::kSift},
         {"corners", DescriptiveFilterKind::kCorners}},
        "features that are counted to reject images that show no place in particular");
  visit("min_features", min_features, hyselam::Range::between(0, 100000), "",
        "below which an image is rejected; 0: 10 by sift, 20 by corners");
}

void DescriptiveFilterParams::validate() const {
  hyselam::checkParameters(*this);
}

DescriptiveFilter::DescriptiveFilter(const DescriptiveFilterParams& params) : params_(params) {
  params.validate();
  if (params_.min_features == 0) {
    params_.min_features =
        params.kind == DescriptiveFilterKind::kSift ? kMinSiftFeatures : kMinCorners;
  }
  if (params.kind == DescriptiveFilterKind::kCorners) {
    detector_ = cv::FastFeatureDetector::create(kCornerContrast);
  } else if (params.kind == DescriptiveFilterKind::kSift) {
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 4)
    detector_ = cv::SIFT::create();
#else
    throw hyselam::InputError("filter of images 'sift'", "", "needs OpenCV 4.4 or newer");
#endif
  }
}

int DescriptiveFilter::count(const cv::Mat& image) {
  if (!detector_) return 0;
  const cv::Mat& gray = grayOf(image, "filter of images", gray_);
  if (params_.kind == DescriptiveFilterKind::kCorners) {
    cv::resize(gray, small_, cv::Size(kWidth, kHeight), 0.0, 0.0, cv::INTER_AREA);
    detector_->detect(small_, keypoints_);
  } else {
    detector_->detect(gray, keypoints_);
  }
  return static_cast<int>(keypoints_.size());
}

bool DescriptiveFilter::accepts(const cv::Mat& image) {
  return params_.kind == DescriptiveFilterKind::kNone || count(image) >= params_.min_features;
}

}  // namespace selovis

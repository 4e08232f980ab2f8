// A picture that is drawn, of 640 x 480: a wall with sixty boxes of any color.
#pragma once

#include <opencv2/imgproc.hpp>

#include "hyselam_common/rng.hpp"

namespace selovis {

inline cv::Mat drawnScene(hyselam::Rng& rng) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(150, 170, 180));
  for (int i = 0; i < 60; ++i) {
    const cv::Rect box(static_cast<int>(rng.below(600)), static_cast<int>(rng.below(440)),
                       20 + static_cast<int>(rng.below(160)),
                       20 + static_cast<int>(rng.below(160)));
    cv::rectangle(image, box, cv::Scalar(rng.below(256), rng.below(256), rng.below(256)),
                  cv::FILLED);
  }
  return image;
}

}  // namespace selovis

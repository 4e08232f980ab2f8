// What a camera makes of what it sees: noise, and how much of it is told.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "hyselam_sim/camera.hpp"

namespace hyselam_sim {

/// From light (CV_32FC3, BGR) to bytes: exposure, white balance, noise, gamma.
cv::Mat develop(const CameraParams& params, const cv::Mat& light, std::uint64_t seed);

/// From depth (CV_32FC1 [m]) to what is measured: noise, whole millimetres, 0 out of range.
cv::Mat measureDepth(const CameraParams& params, const cv::Mat& depth, std::uint64_t seed);

}  // namespace hyselam_sim

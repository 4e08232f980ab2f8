// A colour and depth camera on the robot: level, looking forward, without distortion.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_sim/scene.hpp"

namespace hyselam_sim {

struct CameraParams {
  int width = 640;                       ///< [pixel], 16 .. 4096
  int height = 480;                      ///< [pixel], 16 .. 4096
  double view = hyselam::radians(70.0);  ///< horizontal field of view [rad], (0, 170 degrees]
  Pose2 camera_in_base{0.15, 0.0, 0.0};  ///< where it is mounted
  double above_floor = 1.2;              ///< [m]
  double range = 40.0;                   ///< what is farther is not drawn [m]
  double depth_min = 0.4;                ///< nearer depths read 0 [m]
  double depth_max = 10.0;               ///< farther depths read 0 [m]
  double depth_sigma = 0.0015;           ///< noise of a depth at 1 m; grows with its square [m]
  double noise = 0.012;                  ///< of a colour at full gain, of 1
  double exposure = 0.75;                ///< how far exposure follows the light, 0 .. 1
  double white_balance = 0.6;            ///< how far colours follow the light's colour, 0 .. 1

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError

  /// Focal length [pixel].
  double focalLength() const;
};

/// A picture of the camera.
struct CameraFrame {
  cv::Mat color;  ///< CV_8UC3, BGR
  cv::Mat depth;  ///< CV_16UC1 along the optical axis [mm], 0: none
  cv::Mat owner;  ///< CV_32SC1: Body::owner of each pixel, without noise
};

/// The view of a robot at `base`. The same arguments give the same pixels. `time` [s] is that of
/// the doors and people. @throws hyselam::ParameterError for parameters out of range.
CameraFrame takePicture(const CameraParams& params, const Scene& scene, const LightParams& light,
                        const std::vector<Person>& people, const Pose2& base, double time,
                        hyselam::Rng& rng);

}  // namespace hyselam_sim

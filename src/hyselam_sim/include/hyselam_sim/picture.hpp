// Floor plans and runs as pictures for people.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_sim {

struct PictureOptions {
  double pixels_per_meter = 30.0;  ///< reduced for plans that would exceed `max_side`
  int max_side = 3000;             ///< [pixel]
  double time = 0.0;               ///< at which the doors are drawn [s]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Walls, doors, furniture and names of places, and, if given, the way driven with its start (star)
/// and end (disc); jumps of more than half a metre are drawn as thin dashed lines. BGR, 8 bit.
cv::Mat drawPicture(const FloorPlan& plan, const std::vector<hyselam::StampedPose2>& way = {},
                    const PictureOptions& options = {});

/// Writes a picture (PNG, ...), replacing the file at once. @throws hyselam::InputError if it
/// cannot.
void savePicture(const std::string& path, const cv::Mat& picture);

}  // namespace hyselam_sim

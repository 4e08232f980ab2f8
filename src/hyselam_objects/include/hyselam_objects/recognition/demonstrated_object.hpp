// An object that a person shows to the robot ("this is a cup"), view by view, until its kind is
// learned.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_objects/mapping/object_mapper.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"
#include "hyselam_objects/segmentation/detect_objects.hpp"

namespace hyselam_objects {

class DemonstratedObject {
 public:
  /// `views`: number of views from which a kind is learned, >= 1.
  explicit DemonstratedObject(int views) : views_to_learn_(static_cast<std::size_t>(views)) {}

  /// Starts the demonstration of an object of that kind.
  void start(const std::string& kind);

  /// Adds the detection nearest to the center of the image as a view. Returns the learned object
  /// with the last view; then the demonstration is over.
  std::optional<GenericObject> addView(const std::vector<DetectedObject>& detections,
                                       const PinholeCamera& camera);

 private:
  std::size_t views_to_learn_;
  std::string kind_;  ///< empty: no demonstration
  std::vector<std::vector<float>> views_;
  std::vector<Eigen::Vector3d> sizes_;
};

}  // namespace hyselam_objects

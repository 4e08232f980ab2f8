// A thing that somebody shows to the robot, view by view, until its kind is learnt.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_objects/detect_objects.hpp"
#include "hyselam_objects/object_dictionary.hpp"
#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

class ShownThing {
 public:
  /// `views`: that a kind takes to be learnt, >= 1.
  explicit ShownThing(int views) : views_to_learn_(static_cast<std::size_t>(views)) {}

  /// From now on a thing of that kind is shown.
  void begin(const std::string& kind);

  /// Takes what stands nearest to the middle of the picture for it. Returns what was learnt with
  /// the last view; then nothing is shown any more.
  std::optional<GenericObject> add(const std::vector<DetectedObject>& seen,
                                   const PinholeCamera& camera);

 private:
  std::size_t views_to_learn_;
  std::string kind_;  ///< empty: nothing is shown
  std::vector<std::vector<float>> views_;
  std::vector<Eigen::Vector3d> sizes_;
};

}  // namespace hyselam_objects

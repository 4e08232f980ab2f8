// ObjectDetector (dos Santos, section 3.2.4), second half: updates the object map with the
// detections of a frame.
//
// Data association: a detection belongs to the instance that is nearest in position and
// appearance; a detection without one is a new instance. Instances that should have been seen and
// were not become less probable. One that is gone and one of the same appearance that is new
// elsewhere are the same object, moved.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/mapping/object_relations.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"
#include "hyselam_objects/segmentation/detect_objects.hpp"

namespace hyselam_objects {

struct MapperParams {
  double association_gate = 0.25;  ///< largest distance of a detection from its instance [m], > 0
  double appearance_threshold = 0.5;         ///< ... and largest distance of their descriptors, > 0
  double reidentification_threshold = 0.35;  ///< of descriptors of an object that has moved, > 0
  double p_detection = 0.85;     ///< probability to detect an object that is in view, < 1
  double p_false_alarm = 0.1;    ///< probability to detect one that is not there, 0 .. p_detection
  double position_sigma = 0.03;  ///< of a detection's position [m], > 0
  int min_views = 2;             ///< of a new instance before it is kept, >= 1
  double image_border_margin = 0.06;  ///< share of the frame at each border that is not trusted
  double depth_margin = 0.02;  ///< points this far behind an object show that its place is free [m]
  RelationParams relations;
  MovabilityParams movability;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The camera of a frame.
struct PinholeCamera {
  Eigen::Isometry3d in_map = Eigen::Isometry3d::Identity();  ///< of its optical frame (REP-103)
  double focal_length = 500.0;                               ///< [pixel]
  double cx = 319.5, cy = 239.5;                             ///< principal point [pixel]
};

class ObjectMapper {
 public:
  /// Name and center of the place at a position of the map; nothing: no place is known there.
  using PlaceLookup =
      std::function<std::optional<std::pair<std::string, Point3>>(double x, double y)>;

  /// `map` is changed by update() and consolidate(), and must outlive this. Kinds are recognized
  /// with `dictionary`; unknown ones are "thing".
  /// @throws hyselam::ParameterError.
  ObjectMapper(ObjectMap& map, ObjectDictionary dictionary, const MapperParams& params = {});

  void setPlaceLookup(PlaceLookup lookup) { place_lookup_ = std::move(lookup); }
  void setDictionary(ObjectDictionary dictionary) { dictionary_ = std::move(dictionary); }

  /// Updates the map with one frame, taken at `stamp` [s].
  /// @throws hyselam::InputError as checkCloud().
  void update(const OrganizedCloud& cloud, const PinholeCamera& camera,
              const std::vector<DetectedObject>& detections, double stamp);

  /// Stamp of the last frame [s].
  double time() const { return time_; }

  /// Consolidates the map, now and then or at the end: merges moved objects and parts of furniture,
  /// removes objects with too few views that were last seen before `unconfirmed_before` [s], and
  /// updates the relations.
  void consolidate(double unconfirmed_before = std::numeric_limits<double>::infinity());

 private:
  void resetMergedInstances(const std::vector<DetectedObject>& detections,
                            const std::vector<int>& instances);
  Id addInstance(const DetectedObject& seen, const std::string& kind, double stamp);
  Id findDescribed(const DetectedObject& seen, const std::string& kind) const;
  void assignPlace(Id object);
  void removeUnconfirmed(double unconfirmed_before);

  ObjectMap& map_;
  ObjectDictionary dictionary_;
  MapperParams params_;
  PlaceLookup place_lookup_;
  double time_ = 0.0;
};

}  // namespace hyselam_objects

// ObjectMapper: mapping stage of the ObjectDetector (dos Santos 2014, 3.2.4). Updates the object
// map with the detections of an image.
//
// Data association: a detection belongs to the instance that is nearest in position and
// appearance; a detection without one is a new instance. The existence probability of an instance
// whose space is seen to be free decreases. A disappeared instance and a new one with a similar
// descriptor elsewhere are merged as a moved object.
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
  double appearance_threshold = 0.5;         ///< largest descriptor distance of the two, > 0
  double reidentification_threshold = 0.35;  ///< the same for an object that has moved, > 0
  double p_detection = 0.85;     ///< probability to detect an object that is in view, < 1
  double p_false_alarm = 0.1;    ///< probability to detect one that is not there, 0 .. p_detection
  double position_sigma = 0.03;  ///< standard deviation of a detection's position [m], > 0
  int min_views = 2;             ///< detections of a new instance required to keep it, >= 1
  /// Share of the image width/height at each border that is ignored as free-space evidence.
  double image_border_margin = 0.06;
  /// Points at least this far behind an object count as evidence that its space is free [m].
  double depth_margin = 0.02;
  RelationParams relations;     ///< spatial relations between objects: on, beside, near ...
  MovabilityParams movability;  ///< how likely an object is to be moved, see movability()

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Camera pose and intrinsics of an image.
struct PinholeCamera {
  Eigen::Isometry3d in_map =
      Eigen::Isometry3d::Identity();  ///< pose of the optical frame (REP-103)
  double focal_length = 500.0;        ///< [pixel]
  double cx = 319.5, cy = 239.5;      ///< principal point [pixel]
};

class ObjectMapper {
 public:
  /// Returns name and center [m] of the place (room) at a position [m, map frame], nullopt if there
  /// is none.
  using PlaceLookup =
      std::function<std::optional<std::pair<std::string, Point3>>(double x, double y)>;

  /// `map` is changed by update() and consolidate(), and must outlive this. Kinds are recognized
  /// with `dictionary`; unrecognized kinds are labelled "thing".
  /// @throws hyselam::ParameterError.
  ObjectMapper(ObjectMap& map, ObjectDictionary dictionary, const MapperParams& params = {});

  void setPlaceLookup(PlaceLookup lookup) { place_lookup_ = std::move(lookup); }
  void setDictionary(ObjectDictionary dictionary) { dictionary_ = std::move(dictionary); }

  /// Updates the map with the detections of one image, taken at `stamp` [s].
  /// @throws hyselam::InputError as checkCloud().
  void update(const OrganizedCloud& cloud, const PinholeCamera& camera,
              const std::vector<DetectedObject>& detections, double stamp);

  /// Stamp of the last image [s].
  double time() const { return time_; }

  /// Consolidates the map; to be called periodically or at the end: merges moved objects and parts
  /// of furniture, removes objects with too few views that were last seen before
  /// `unconfirmed_before` [s], and updates the relations.
  void consolidate(double unconfirmed_before = std::numeric_limits<double>::infinity());

 private:
  /// Where two detections lie within one instance, that instance was several objects seen as one:
  /// resets its pose. instances[i]: index of the instance of detections[i] in the map, -1: none.
  void resetMergedInstances(const std::vector<DetectedObject>& detections,
                            const std::vector<int>& instances);
  /// Whether it is of a known kind, and no larger than such are.
  bool isWholeKind(const ObjectInstance& object) const;
  /// Whether a detection that belongs to no instance is a face of a known object. `kind`: as which
  /// it was recognized; "": not recognized.
  bool isPartOfKnown(const DetectedObject& seen, const std::string& kind) const;
  Id addInstance(const DetectedObject& seen, const std::string& kind, double stamp);
  /// An object that a person has described but that has not been seen yet, of the same kind and in
  /// the same place as the detection; 0: none.
  Id findDescribed(const DetectedObject& seen, const std::string& kind) const;
  void assignPlace(Id object);
  bool isUnconfirmed(const ObjectInstance& object, double before) const;
  bool isDenied(const ObjectInstance& object) const;
  bool isNoObject(const ObjectInstance& object) const;
  void removeUnconfirmed(double unconfirmed_before);

  ObjectMap& map_;
  ObjectDictionary dictionary_;
  MapperParams params_;
  PlaceLookup place_lookup_;
  double time_ = 0.0;
};

}  // namespace hyselam_objects

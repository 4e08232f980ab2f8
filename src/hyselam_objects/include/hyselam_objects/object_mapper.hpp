// ObjectDetector's second half: what was seen in one frame and what the map has become one.
//
// A detection belongs to the instance that is nearest in place and looks; what fits none is new.
// Instances that should have been seen and were not lose evidence. One that is gone and one of the
// same looks that is new elsewhere are the same thing, moved.
#pragma once

#include <functional>
#include <limits>

#include "hyselam_objects/detect_objects.hpp"
#include "hyselam_objects/object_dictionary.hpp"
#include "hyselam_objects/object_map.hpp"
#include "hyselam_objects/object_relations.hpp"

namespace hyselam_objects {

struct MapperParams {
  double gate = 0.25;            ///< a thing and its instance are nearer than this at most [m]
  double look = 0.5;             ///< ... and their descriptors nearer than this
  double refind_look = 0.35;     ///< the same for things that have moved
  double seen_if_there = 0.85;   ///< probability to detect what is in view
  double seen_if_not = 0.1;      ///< and to detect something there that is not
  double sigma = 0.03;           ///< of a detection's position [m]
  int confirm = 2;               ///< views before something new is in the map
  double visible_margin = 0.06;  ///< share of the frame at each border that is not trusted
  double depth_margin = 0.02;    ///< what is seen this far behind something looks through it [m]
  RelationParams relations;
  MovabilityParams movability;
};

/// The camera of a frame.
struct PinholeCamera {
  Eigen::Isometry3d in_map = Eigen::Isometry3d::Identity();
  double focal_length = 500.0;  ///< [pixel]
  double cx = 319.5, cy = 239.5;
};

class ObjectMapper {
 public:
  using PlaceAt = std::function<std::optional<std::pair<std::string, Point3>>(double x, double y)>;

  /// `map` must outlive this. `dictionary` tells kinds; others are "thing".
  ObjectMapper(ObjectMap* map, ObjectDictionary dictionary, const MapperParams& params = {});

  /// Name and middle of the place at a position; nothing: none is known there.
  void setPlaces(PlaceAt place_at) { place_at_ = std::move(place_at); }
  void setDictionary(ObjectDictionary dictionary) { dictionary_ = std::move(dictionary); }

  /// One frame at a time [s]. Throws as checkCloud().
  void update(const OrganisedCloud& cloud, const PinholeCamera& camera,
              const std::vector<DetectedObject>& detections, double stamp);

  /// Stamp of the last frame [s].
  double time() const { return time_; }

  /// After a tour, or now and then: joins moved things and parts of furniture, drops what was seen
  /// too seldom, and last before `weak_before` [s], makes relations anew.
  void finish(double weak_before = std::numeric_limits<double>::infinity());

 private:
  void forgetGroups(const std::vector<DetectedObject>& detections, const std::vector<int>& of);
  Id add(const DetectedObject& seen, const std::string& kind, double stamp);
  Id findTold(const DetectedObject& seen, const std::string& kind) const;
  void place(Id object);
  void dropDoubtful(double weak_before);

  ObjectMap& map_;
  ObjectDictionary dictionary_;
  MapperParams params_;
  PlaceAt place_at_;
  double time_ = 0.0;
};

}  // namespace hyselam_objects

#include "update_instance.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "instance_traits.hpp"

namespace hyselam_objects {
namespace {

/// Bayes' rule for the existence of an object that was detected or missed.
double updatedExistence(double p, bool positive, const MapperParams& params) {
  const double there = positive ? params.p_detection : 1.0 - params.p_detection;
  const double not_there = positive ? params.p_false_alarm : 1.0 - params.p_false_alarm;
  const double q = p * there / (p * there + (1.0 - p) * not_there);
  return std::clamp(q, 0.001, 0.999);  // never certain: it may move
}

void setVariance(ObjectPose& pose, double variance) {
  for (const std::size_t i : {0u, 4u, 8u}) pose.covariance[i] = variance;
}

/// One step of a Kalman filter for the box and the descriptor; the outline is that of all views.
void filterBox(ObjectInstance& object, const DetectedObject& seen, double variance) {
  constexpr double kTaller = 1.4;  // what was known was only a part
  ObjectPose& pose = *object.pose;
  const ObjectPose box = boxOf(seen);
  if (box.size[2] > kTaller * pose.size[2]) setVariance(pose, 100.0 * variance);
  const double gain = pose.covariance[0] / (pose.covariance[0] + variance);
  object.outline = outlineOf(object);
  addView(object.outline, outlineOf(seen), gain);
  setGround(pose, boxAround(object.outline));
  pose.position.z += gain * (box.position.z - pose.position.z);
  pose.size[2] += gain * (box.size[2] - pose.size[2]);
  // Views are not independent: the standard deviation stays above a third of that of one view.
  for (const std::size_t i : {0u, 4u, 8u}) {
    pose.covariance[i] = std::max((1.0 - gain) * pose.covariance[i], variance / 9.0);
  }
  for (std::size_t i = 0; i < object.descriptor.size() && i < seen.descriptor.size(); ++i) {
    object.descriptor[i] +=
        static_cast<float>(std::max(gain, 0.1)) * (seen.descriptor[i] - object.descriptor[i]);
  }
}

/// Extends the last stay of the history, or begins another one.
void updateHistory(ObjectInstance& object, double stamp) {
  auto& history = object.history;
  // Time may jump back, as when a bag is played again.
  if (history.empty() || std::abs(stamp - history.back().until) > kMaxAbsence) {
    history.push_back({stamp, stamp, object.pose->position});
    forgetOldStays(object);
  }
  history.back().until = std::max(history.back().until, stamp);
  history.back().position = object.pose->position;
}

}  // namespace

void addDetection(ObjectInstance& object, const DetectedObject& seen, const std::string& kind,
                  double stamp, const MapperParams& params) {
  constexpr double kWhole = 0.7;
  const ObjectPose box = boxOf(seen);
  const double variance = params.position_sigma * params.position_sigma;
  if (!object.pose) {
    object.pose = box;
    object.outline = seen.outline;
    setVariance(*object.pose, variance);
    object.descriptor = seen.descriptor;
  } else if (seen.furniture) {
    // Each view shows a part of it.
    unite(object, seen);
  } else if (box.size[2] > kWhole * object.pose->size[2]) {  // otherwise a part was seen
    filterBox(object, seen, variance);
  }
  if (!kind.empty() && (object.kind == kUnknownKind || object.kind == kFurnitureKind)) {
    object.kind = kind;
  }
  if (!seen.color.empty()) object.properties.emplace("colour", seen.color);
  ++object.detections;
  object.existence = updatedExistence(object.existence, true, params);
  updateHistory(object, stamp);
  object.last_seen = stamp;
}

void addMissedDetection(ObjectInstance& object, double stamp, const MapperParams& params) {
  constexpr double kMaxAfterAbsence = 0.8;  // it may have been moved since the last visit
  if (stamp - object.last_seen > kMaxAbsence) {
    object.existence = std::min(object.existence, kMaxAfterAbsence);
  }
  ++object.missed_detections;
  object.existence = updatedExistence(object.existence, false, params);
}

}  // namespace hyselam_objects

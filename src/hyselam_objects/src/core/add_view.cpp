#include "add_view.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "instance_traits.hpp"

namespace hyselam_objects {
namespace {

double updated(double p, bool positive, const MapperParams& params) {
  const double there = positive ? params.seen_if_there : 1.0 - params.seen_if_there;
  const double not_there = positive ? params.seen_if_not : 1.0 - params.seen_if_not;
  const double q = p * there / (p * there + (1.0 - p) * not_there);
  return std::clamp(q, 0.001, 0.999);
}

void setVariance(ObjectPose* pose, double variance) {
  for (const std::size_t i : {0u, 4u, 8u}) pose->covariance[i] = variance;
}

/// One step of the filter for the box and the descriptor.
void filter(ObjectInstance* object, const DetectedObject& seen, double variance) {
  ObjectPose& pose = *object->pose;
  const std::array<double, 3> size = boxOf(seen).size;
  // What was known was only a part.
  if (size[2] > 1.4 * pose.size[2]) setVariance(&pose, 100.0 * variance);
  const double gain = pose.covariance[0] / (pose.covariance[0] + variance);
  const Point3 c = seen.center();
  pose.position.x += gain * (c.x - pose.position.x);
  pose.position.y += gain * (c.y - pose.position.y);
  pose.position.z += gain * (c.z - pose.position.z);
  for (std::size_t k = 0; k < 3; ++k) pose.size[k] += gain * (size[k] - pose.size[k]);
  // Views are not independent: never surer than a third of one view.
  for (const std::size_t i : {0u, 4u, 8u}) {
    pose.covariance[i] = std::max((1.0 - gain) * pose.covariance[i], variance / 9.0);
  }
  for (std::size_t i = 0; i < object->descriptor.size() && i < seen.descriptor.size(); ++i) {
    object->descriptor[i] +=
        static_cast<float>(std::max(gain, 0.1)) * (seen.descriptor[i] - object->descriptor[i]);
  }
}

void stay(ObjectInstance* object, double stamp) {
  auto& history = object->history;
  // Time may go back, as when a bag begins again.
  if (history.empty() || std::abs(stamp - history.back().until) > kAbsence) {
    history.push_back({stamp, stamp, object->pose->position});
  }
  history.back().until = std::max(history.back().until, stamp);
  history.back().position = object->pose->position;
}

}  // namespace

void addView(ObjectInstance* object, const DetectedObject& seen, const std::string& kind,
             double stamp, const MapperParams& params) {
  const ObjectPose box = boxOf(seen);
  const double variance = params.sigma * params.sigma;
  if (!object->pose) {
    object->pose = box;
    setVariance(&*object->pose, variance);
    object->descriptor = seen.descriptor;
  } else if (seen.furniture) {
    // Each view shows a part.
    unite(&*object->pose, box);
  } else if (box.size[2] > 0.7 * object->pose->size[2]) {  // less: only a part was seen
    filter(object, seen, variance);
  }
  if (!kind.empty() && (object->kind == kUnknown || object->kind == kFurniture))
    object->kind = kind;
  if (!seen.colour.empty()) object->properties.emplace("colour", seen.colour);
  ++object->seen;
  object->existence = updated(object->existence, true, params);
  stay(object, stamp);
  object->last_seen = stamp;
}

void addMiss(ObjectInstance* object, double stamp, const MapperParams& params) {
  constexpr double kLongAgo = 0.8;  // what was there at the last visit may have gone since
  if (stamp - object->last_seen > kAbsence) {
    object->existence = std::min(object->existence, kLongAgo);
  }
  ++object->missed;
  object->existence = updated(object->existence, false, params);
}

}  // namespace hyselam_objects

#include "data_association.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "assign.hpp"
#include "boxes.hpp"
#include "furniture.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"
#include "instance_traits.hpp"

namespace hyselam_objects {
namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();
// Of furniture and its detection: height of the tops [m], overlap of the footprints.
constexpr double kMaxHeightDifference = 0.06, kMinOverlap = 0.3;

// Three standard deviations; and a view shows one side, so that its center may be off by half of
// the object.
double gateOf(const ObjectPose& pose, const MapperParams& params) {
  const double variance = pose.covariance[0] + params.position_sigma * params.position_sigma;
  const double half = 0.5 * std::max({pose.size[0], pose.size[1], pose.size[2]});
  return std::min(params.association_gate, 3.0 * std::sqrt(variance) + half);
}

double costOfFurniture(const ObjectPose& pose, const DetectedObject& seen) {
  const double height = pose.position.z + 0.5 * pose.size[2];
  const double overlap = footprintOverlap(pose, boxOf(seen));
  if (std::abs(height - seen.high.z) > kMaxHeightDifference || overlap < kMinOverlap) {
    return kImpossible;
  }
  return 1.0 - overlap;
}

double costOfObject(const ObjectInstance& object, const DetectedObject& seen, double stamp,
                    const MapperParams& params) {
  const double away = distance(object.pose->position, boxOf(seen).position);
  const double appearance = descriptorDistance(object.descriptor, seen.descriptor);
  // Two objects are not at one spot; a part of an object may appearance different.
  const bool same_visit = std::abs(stamp - object.last_seen) < kMaxAbsence;
  const bool same_spot = same_visit && areAtSameSpot(*object.pose, boxOf(seen));
  if (away > gateOf(*object.pose, params) ||
      (appearance > params.appearance_threshold && !same_spot)) {
    return kImpossible;
  }
  return away / params.association_gate + std::min(1.0, appearance / params.appearance_threshold);
}

}  // namespace

SeparateDetections separateDetections(const ObjectMap& map, const std::vector<DetectedObject>& all,
                                      double stamp, const MapperParams& params) {
  SeparateDetections out;
  for (const DetectedObject& seen : all) {
    std::vector<Id> known;
    const ObjectPose box = boxOf(seen);
    if (seen.furniture && isOnFurniture(map, box)) continue;
    for (const ObjectInstance& object : map.objects) {
      if (!seen.furniture && object.pose && !isFurniture(object) &&
          object.detections >= params.min_views && object.existence > 0.5 &&
          std::abs(stamp - object.last_seen) < kMaxAbsence &&
          contains(box, object.pose->position)) {
        known.push_back(object.id);
      }
    }
    if (known.size() < 2) {
      out.detections.push_back(seen);
    } else {
      out.merged.insert(out.merged.end(), known.begin(), known.end());
    }
  }
  return out;
}

std::vector<int> associateDetections(const ObjectMap& map,
                                     const std::vector<DetectedObject>& detections, double stamp,
                                     const MapperParams& params) {
  std::vector<std::vector<double>> cost(detections.size(),
                                        std::vector<double>(map.objects.size(), kImpossible));
  for (std::size_t o = 0; o < map.objects.size(); ++o) {
    const ObjectInstance& object = map.objects[o];
    if (!object.pose) continue;
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const DetectedObject& seen = detections[d];
      if (isFurniture(object) != seen.furniture) continue;
      cost[d][o] = seen.furniture ? costOfFurniture(*object.pose, seen)
                                  : costOfObject(object, seen, stamp, params);
    }
  }
  constexpr double kMaxCost = 2.0;  // of a possible pair: one for distance, one for appearance
  return assignRows(cost, kMaxCost);
}

}  // namespace hyselam_objects

#include "associate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "assign.hpp"
#include "boxes.hpp"
#include "furniture.hpp"
#include "hyselam_objects/object_descriptor.hpp"
#include "instance_traits.hpp"

namespace hyselam_objects {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// Three standard deviations; and a view shows one side, so its middle may be off by half of the
// thing.
double gateOf(const ObjectPose& pose, const MapperParams& params) {
  const double variance = pose.covariance[0] + params.sigma * params.sigma;
  const double half = 0.5 * std::max({pose.size[0], pose.size[1], pose.size[2]});
  return std::min(params.gate, 3.0 * std::sqrt(variance) + half);
}

double costOfFurniture(const ObjectPose& pose, const DetectedObject& seen) {
  const double height = pose.position.z + 0.5 * pose.size[2];
  if (std::abs(height - seen.high.z) > 0.06 || overlap(pose, seen) < 0.3) return kNever;
  return 1.0 - overlap(pose, seen);
}

double costOfThing(const ObjectInstance& object, const DetectedObject& seen, double stamp,
                   const MapperParams& params) {
  const double away = distance(object.pose->position, seen.center());
  const double look = viewDistance(object.descriptor, seen.descriptor);
  // Where one thing is there is no other: a part of it looks different.
  const bool same_visit = std::abs(stamp - object.last_seen) < kAbsence;
  const bool same_spot = same_visit && isSameSpot(*object.pose, boxOf(seen));
  if (away > gateOf(*object.pose, params) || (look > params.look && !same_spot)) return kNever;
  return away / params.gate + std::min(1.0, look / params.look);
}

}  // namespace

std::vector<DetectedObject> singleThings(const ObjectMap& map,
                                         const std::vector<DetectedObject>& all, double stamp,
                                         const MapperParams& params, std::vector<Id>* within) {
  std::vector<DetectedObject> out;
  for (const DetectedObject& seen : all) {
    std::vector<Id> known;
    const ObjectPose box = boxOf(seen);
    if (seen.furniture && isOnFurniture(map, box)) continue;
    for (const ObjectInstance& object : map.objects) {
      if (!seen.furniture && object.pose && !isFurniture(object) && object.seen >= params.confirm &&
          object.existence > 0.5 && std::abs(stamp - object.last_seen) < kAbsence &&
          isIn(box, object.pose->position)) {
        known.push_back(object.id);
      }
    }
    if (known.size() < 2) {
      out.push_back(seen);
    } else {
      within->insert(within->end(), known.begin(), known.end());
    }
  }
  return out;
}

std::vector<int> associate(const ObjectMap& map, const std::vector<DetectedObject>& detections,
                           double stamp, const MapperParams& params) {
  std::vector<std::vector<double>> cost(detections.size(),
                                        std::vector<double>(map.objects.size(), kNever));
  for (std::size_t o = 0; o < map.objects.size(); ++o) {
    const ObjectInstance& object = map.objects[o];
    if (!object.pose) continue;
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const DetectedObject& seen = detections[d];
      if (isFurniture(object) != seen.furniture) continue;
      cost[d][o] = seen.furniture ? costOfFurniture(*object.pose, seen)
                                  : costOfThing(object, seen, stamp, params);
    }
  }
  return assignRows(cost, 2.0);  // no pair that is possible costs more
}

}  // namespace hyselam_objects

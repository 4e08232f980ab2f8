#include "reassociate_moved.hpp"

#include <algorithm>
#include <limits>

#include "assign.hpp"
#include "boxes.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"
#include "instance_traits.hpp"
#include "keep_described.hpp"

namespace hyselam_objects {
namespace {

// Existence below which an object may be the one that is new elsewhere.
constexpr double kGone = 0.45;

/// Cost of taking one for the other, moved; infinity: it is not.
double costOfMove(const ObjectInstance& old, const ObjectInstance& found, double now,
                  const MapperParams& params) {
  constexpr double kCostPerMeter = 1e-3;  // decides between objects that look the same
  // Share of the time since it was last seen after which the other one must have appeared.
  constexpr double kMinAbsenceShare = 0.2;
  const bool later = found.history.front().from - old.last_seen >
                     kMinAbsenceShare * std::max(0.0, now - old.last_seen);
  const bool other_kind =
      old.kind != found.kind && old.kind != kUnknownKind && found.kind != kUnknownKind;
  const double appearance = descriptorDistance(old.descriptor, found.descriptor);
  // Recognized as one kind, they need be no more alike than the views of one object.
  const bool same_kind = old.kind == found.kind && old.kind != kUnknownKind;
  const double threshold =
      same_kind ? std::max(params.reidentification_threshold, params.appearance_threshold)
                : params.reidentification_threshold;
  if (!later || other_kind || appearance >= threshold) {
    return std::numeric_limits<double>::infinity();
  }
  return appearance + kCostPerMeter * distance(old.pose->position, found.pose->position);
}

/// Makes both the instance `gone`, with the position of `found`.
void merge(ObjectMap& map, Id gone, Id found) {
  ObjectInstance& old = *map.find(gone);
  ObjectInstance& now = *map.find(found);
  now.history.insert(now.history.begin(), old.history.begin(), old.history.end());
  forgetOldStays(now);
  now.detections += old.detections;
  now.described = now.described || old.described;
  if (now.kind == kUnknownKind) now.kind = old.kind;
  now.properties.insert(old.properties.begin(), old.properties.end());
  // The older id stays; relations described for its former place do not hold any more.
  ObjectInstance kept = now;
  kept.id = gone;
  auto& all = map.relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const auto& r) { return r.object == gone || r.other == gone; }),
            all.end());
  keepDescribedRelations(map, found, gone);
  map.remove(found);
  *map.find(gone) = std::move(kept);
}

}  // namespace

void reassociateMoved(ObjectMap& map, double now, const MapperParams& params) {
  std::vector<Id> gone, found;
  for (const ObjectInstance& each : map.objects) {
    if (!each.pose || isFurniture(each)) continue;
    if (each.existence <= kGone && each.detections >= params.min_views) gone.push_back(each.id);
    if (each.existence >= 0.5 && !each.history.empty()) found.push_back(each.id);
  }
  if (gone.empty() || found.empty()) return;
  std::vector<std::vector<double>> cost;
  for (const Id id : gone) {
    cost.emplace_back();
    for (const Id other : found) {
      cost.back().push_back(costOfMove(*map.find(id), *map.find(other), now, params));
    }
  }
  const double unassigned_cost =  // above all possible pairs
      2.0 * std::max(params.reidentification_threshold, params.appearance_threshold);
  const std::vector<int> assigned = assignRows(cost, unassigned_cost);
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (assigned[i] >= 0) merge(map, gone[i], found[static_cast<std::size_t>(assigned[i])]);
  }
}

}  // namespace hyselam_objects

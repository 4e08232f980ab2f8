#include "join_moved.hpp"

#include <algorithm>
#include <limits>

#include "assign.hpp"
#include "boxes.hpp"
#include "hyselam_objects/object_descriptor.hpp"
#include "instance_traits.hpp"
#include "keep_told.hpp"

namespace hyselam_objects {
namespace {

// Less likely than this to be where it was: it may be what is new elsewhere.
constexpr double kGone = 0.45;

/// What it costs that one is the other, moved; infinity: it is not.
double costOf(const ObjectInstance& old, const ObjectInstance& found, double now,
              const MapperParams& params) {
  constexpr double kPerMetre = 1e-3;   // between things that look the same
  constexpr double kLeastShare = 0.2;  // of the time in which it may have been moved
  const bool later =
      found.history.front().from - old.last_seen > kLeastShare * std::max(0.0, now - old.last_seen);
  const bool other_kind = old.kind != found.kind && old.kind != kUnknown && found.kind != kUnknown;
  const double look = viewDistance(old.descriptor, found.descriptor);
  if (!later || other_kind || look >= params.refind_look) {
    return std::numeric_limits<double>::infinity();
  }
  return look + kPerMetre * distance(old.pose->position, found.pose->position);
}

void merge(Id gone, Id found, ObjectMap* map) {
  ObjectInstance& old = *map->find(gone);
  ObjectInstance& now = *map->find(found);
  now.history.insert(now.history.begin(), old.history.begin(), old.history.end());
  now.seen += old.seen;
  now.told = now.told || old.told;
  if (now.kind == kUnknown) now.kind = old.kind;
  now.properties.insert(old.properties.begin(), old.properties.end());
  // The id that others know stays; what was told of where it was does not hold any more.
  ObjectInstance kept = now;
  kept.id = gone;
  auto& all = map->relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const auto& r) { return r.object == gone || r.other == gone; }),
            all.end());
  keepTold(found, gone, map);
  map->remove(found);
  *map->find(gone) = std::move(kept);
}

}  // namespace

void joinMoved(ObjectMap* map, double now, const MapperParams& params) {
  std::vector<Id> gone, found;
  for (const ObjectInstance& each : map->objects) {
    if (!each.pose || isFurniture(each)) continue;
    if (each.existence <= kGone && each.seen >= params.confirm) gone.push_back(each.id);
    if (each.existence >= 0.5 && !each.history.empty()) found.push_back(each.id);
  }
  if (gone.empty() || found.empty()) return;
  std::vector<std::vector<double>> cost;
  for (const Id id : gone) {
    cost.emplace_back();
    for (const Id other : found) {
      cost.back().push_back(costOf(*map->find(id), *map->find(other), now, params));
    }
  }
  const double without = 2.0 * params.refind_look;  // any pair is better than none
  const std::vector<int> of = assignRows(cost, without);
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (of[i] >= 0) merge(gone[i], found[static_cast<std::size_t>(of[i])], map);
  }
}

}  // namespace hyselam_objects

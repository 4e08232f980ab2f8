#include "hyselam_objects/object_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "assign.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_objects/object_descriptor.hpp"

namespace hyselam_objects {
namespace {

constexpr char kUnknown[] = "thing";
constexpr char kFurniture[] = "furniture";
// A stay is left when nothing was seen there for so long: then it is another visit [s].
constexpr double kAbsence = 60.0;
// Less likely than this to be where it was: it may be what is new elsewhere.
constexpr double kGone = 0.45;

double distance(const Point3& a, const Point3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// Share of the smaller one's ground that two boxes have in common.
double overlap(const ObjectPose& a, const DetectedObject& b) {
  const auto common = [](double low1, double high1, double low2, double high2) {
    return std::max(0.0, std::min(high1, high2) - std::max(low1, low2));
  };
  const double x =
      common(a.position.x - 0.5 * a.size[0], a.position.x + 0.5 * a.size[0], b.low.x, b.high.x);
  const double y =
      common(a.position.y - 0.5 * a.size[1], a.position.y + 0.5 * a.size[1], b.low.y, b.high.y);
  const double least = std::min(a.size[0] * a.size[1], (b.high.x - b.low.x) * (b.high.y - b.low.y));
  return least > 0.0 ? x * y / least : 0.0;
}

double updated(double p, bool positive, const MapperParams& params) {
  const double there = positive ? params.seen_if_there : 1.0 - params.seen_if_there;
  const double not_there = positive ? params.seen_if_not : 1.0 - params.seen_if_not;
  const double q = p * there / (p * there + (1.0 - p) * not_there);
  return std::clamp(q, 0.001, 0.999);
}

/// Whether something lies in the body of a piece of furniture: a part of it that was not told from
/// it.
bool isPartOf(const ObjectPose& furniture, const Point3& p) {
  constexpr double kMargin = 0.08, kBelowTop = 0.03;
  return std::abs(p.x - furniture.position.x) < 0.5 * furniture.size[0] + kMargin &&
         std::abs(p.y - furniture.position.y) < 0.5 * furniture.size[1] + kMargin &&
         p.z < furniture.position.z + 0.5 * furniture.size[2] - kBelowTop;
}

/// Two parts of one top: of the same height, overlapping or hardly apart.
bool isOneTop(const ObjectPose& a, const ObjectPose& b) {
  constexpr double kStep = 0.04, kGap = 0.15;
  const double height = a.position.z + 0.5 * a.size[2] - b.position.z - 0.5 * b.size[2];
  return std::abs(height) < kStep &&
         std::abs(a.position.x - b.position.x) < 0.5 * (a.size[0] + b.size[0]) + kGap &&
         std::abs(a.position.y - b.position.y) < 0.5 * (a.size[1] + b.size[1]) + kGap;
}

/// Makes the first box large enough for both.
void unite(ObjectPose* a, const ObjectPose& b) {
  const std::array<double, 3> other{b.position.x, b.position.y, b.position.z};
  const std::array<double*, 3> middle{&a->position.x, &a->position.y, &a->position.z};
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = std::min(*middle[k] - 0.5 * a->size[k], other[k] - 0.5 * b.size[k]);
    const double high = std::max(*middle[k] + 0.5 * a->size[k], other[k] + 0.5 * b.size[k]);
    *middle[k] = 0.5 * (low + high);
    a->size[k] = high - low;
  }
}

ObjectPose boxOf(const DetectedObject& seen) {
  return {seen.centre(),
          {seen.high.x - seen.low.x, seen.high.y - seen.low.y, seen.high.z - seen.low.z},
          0.0,
          {}};
}

/// Whether a point lies in the box of a thing, seen from above.
bool isOn(const ObjectPose& box, const Point3& p) {
  constexpr double kMargin = 0.02;
  return std::abs(p.x - box.position.x) < 0.5 * box.size[0] + kMargin &&
         std::abs(p.y - box.position.y) < 0.5 * box.size[1] + kMargin;
}

bool isIn(const ObjectPose& box, const Point3& p) {
  return isOn(box, p) && std::abs(p.z - box.position.z) < 0.5 * box.size[2];
}

/// Whether two boxes are so much in one spot that they must be of one thing, or of a part of it.
bool isSameSpot(const ObjectPose& a, const ObjectPose& b) {
  const double low = std::max(a.position.z - 0.5 * a.size[2], b.position.z - 0.5 * b.size[2]);
  const double high = std::min(a.position.z + 0.5 * a.size[2], b.position.z + 0.5 * b.size[2]);
  return isOn(a, b.position) && isOn(b, a.position) &&
         high - low > 0.5 * std::min(a.size[2], b.size[2]);
}

/// Share of the first box's volume that lies in the second one.
double shareWithin(const ObjectPose& a, const ObjectPose& b) {
  const std::array<double, 3> p{a.position.x, a.position.y, a.position.z},
      q{b.position.x, b.position.y, b.position.z};
  double share = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = std::max(p[k] - 0.5 * a.size[k], q[k] - 0.5 * b.size[k]);
    const double high = std::min(p[k] + 0.5 * a.size[k], q[k] + 0.5 * b.size[k]);
    share *= std::max(0.0, high - low) / std::max(a.size[k], 1e-6);
  }
  return share;
}

bool isFurniture(const ObjectInstance& object) {
  return object.properties.count("furniture") != 0;
}

/// Whether a level surface is that of things on a piece of furniture, not of another piece.
bool isTopOfThings(const ObjectPose& top, const ObjectPose& furniture) {
  constexpr double kTallest = 0.6, kMargin = 0.05;  // as in SegmentParams
  const double step =
      top.position.z + 0.5 * top.size[2] - furniture.position.z - 0.5 * furniture.size[2];
  if (step < 0.03 || step > kTallest) return false;
  if (top.size[0] * top.size[1] > 0.7 * furniture.size[0] * furniture.size[1]) return false;
  ObjectPose ground = top, body = furniture;  // the share of the ground
  body.size[0] += 2.0 * kMargin, body.size[1] += 2.0 * kMargin;
  ground.position.z = body.position.z = 0.0;
  ground.size[2] = body.size[2] = 1.0;
  return shareWithin(ground, body) > 0.8;
}

}  // namespace

ObjectMapper::ObjectMapper(ObjectMap* map, ObjectDictionary dictionary, const MapperParams& params)
    : map_(*map), dictionary_(std::move(dictionary)), params_(params) {
  using hyselam::require;
  require("gate", params.gate, params.gate > 0.0, "> 0");
  require("look", params.look, params.look > 0.0, "> 0");
  require("refind_look", params.refind_look, params.refind_look > 0.0, "> 0");
  require("seen_if_there", params.seen_if_there,
          params.seen_if_there > params.seen_if_not && params.seen_if_there < 1.0,
          "above seen_if_not and below 1");
  require("seen_if_not", params.seen_if_not, params.seen_if_not > 0.0, "> 0");
  require("sigma", params.sigma, params.sigma > 0.0, "> 0");
  require("confirm", params.confirm, params.confirm >= 1, ">= 1");
}

std::vector<int> ObjectMapper::associate(const std::vector<DetectedObject>& detections,
                                         double stamp) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> cost(detections.size(),
                                        std::vector<double>(map_.objects.size(), kNever));
  for (std::size_t o = 0; o < map_.objects.size(); ++o) {
    const ObjectInstance& object = map_.objects[o];
    if (!object.pose) continue;
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const DetectedObject& seen = detections[d];
      if (isFurniture(object) != seen.furniture) continue;
      if (seen.furniture) {
        const double height = object.pose->position.z + 0.5 * object.pose->size[2];
        if (std::abs(height - seen.high.z) > 0.06 || overlap(*object.pose, seen) < 0.3) continue;
        cost[d][o] = 1.0 - overlap(*object.pose, seen);
        continue;
      }
      const double away = distance(object.pose->position, seen.centre());
      const double look = viewDistance(object.descriptor, seen.descriptor);
      // Where one thing is there is no other: a part of it looks different.
      const bool same_visit = std::abs(stamp - object.last_seen) < kAbsence;
      const bool same_spot = same_visit && isSameSpot(*object.pose, boxOf(seen));
      if (away > gateOf(*object.pose) || (look > params_.look && !same_spot)) continue;
      cost[d][o] = away / params_.gate + std::min(1.0, look / params_.look);
    }
  }
  return assignRows(cost, 2.0);  // no pair that is possible costs more
}

// Three standard deviations; and a view shows one side, so its middle may be off by half of the
// thing.
double ObjectMapper::gateOf(const ObjectPose& pose) const {
  const double variance = pose.covariance[0] + params_.sigma * params_.sigma;
  const double half = 0.5 * std::max({pose.size[0], pose.size[1], pose.size[2]});
  return std::min(params_.gate, 3.0 * std::sqrt(variance) + half);
}

void ObjectMapper::take(ObjectInstance* object, const DetectedObject& seen, const std::string& kind,
                        double stamp) {
  const std::array<double, 3> size{seen.high.x - seen.low.x, seen.high.y - seen.low.y,
                                   seen.high.z - seen.low.z};
  const double variance = params_.sigma * params_.sigma;
  if (!object->pose) {
    object->pose = ObjectPose{seen.centre(), size, 0.0, {}};
    for (const std::size_t i : {0u, 4u, 8u}) object->pose->covariance[i] = variance;
    object->descriptor = seen.descriptor;
  } else if (seen.furniture) {
    // Each view shows a part.
    unite(&*object->pose, boxOf(seen));
  } else if (size[2] > 0.7 * object->pose->size[2]) {  // less: only a part was seen
    ObjectPose& pose = *object->pose;
    // What was known was only a part.
    if (size[2] > 1.4 * pose.size[2]) {
      for (const std::size_t i : {0u, 4u, 8u}) pose.covariance[i] = 100.0 * variance;
    }
    const double gain = pose.covariance[0] / (pose.covariance[0] + variance);
    const Point3 c = seen.centre();
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
  if (!kind.empty() && (object->kind == kUnknown || object->kind == kFurniture))
    object->kind = kind;
  if (!seen.colour.empty()) object->properties.emplace("colour", seen.colour);
  ++object->seen;
  object->existence = updated(object->existence, true, params_);
  // Time may go back, as when a bag begins again.
  if (object->history.empty() || std::abs(stamp - object->history.back().until) > kAbsence) {
    object->history.push_back({stamp, stamp, object->pose->position});
  }
  object->history.back().until = std::max(object->history.back().until, stamp);
  object->history.back().position = object->pose->position;
  object->last_seen = stamp;
}

bool ObjectMapper::isOnFurniture(const ObjectPose& top, Id except) const {
  return std::any_of(map_.objects.begin(), map_.objects.end(), [&](const auto& o) {
    return o.id != except && o.pose && isFurniture(o) && isTopOfThings(top, *o.pose);
  });
}

// Tops of things that were taken for furniture while that which carries them was out of view.
void ObjectMapper::dropTopsOfThings() {
  std::vector<Id> dropped;
  for (const ObjectInstance& object : map_.objects) {
    if (object.pose && !object.told && isFurniture(object) &&
        isOnFurniture(*object.pose, object.id)) {
      dropped.push_back(object.id);
    }
  }
  for (const Id id : dropped) map_.remove(id);
}

// Without those that are several known things in one, and tops of things on known furniture.
std::vector<DetectedObject> ObjectMapper::apart(const std::vector<DetectedObject>& all,
                                                double stamp, std::vector<Id>* matched) const {
  std::vector<DetectedObject> out;
  for (const DetectedObject& seen : all) {
    std::vector<Id> within;
    const ObjectPose box = boxOf(seen);
    if (seen.furniture && isOnFurniture(box, 0)) continue;
    for (const ObjectInstance& object : map_.objects) {
      if (!seen.furniture && object.pose && !isFurniture(object) &&
          object.seen >= params_.confirm && object.existence > 0.5 &&
          std::abs(stamp - object.last_seen) < kAbsence && isIn(box, object.pose->position)) {
        within.push_back(object.id);
      }
    }
    if (within.size() < 2) {
      out.push_back(seen);
    } else {
      matched->insert(matched->end(), within.begin(), within.end());
    }
  }
  return out;
}

void ObjectMapper::update(const OrganisedCloud& cloud, const PinholeCamera& camera,
                          const std::vector<DetectedObject>& all, double stamp) {
  checkSegment(cloud, SegmentParams{});
  time_ = stamp;
  dropTopsOfThings();
  std::vector<Id> matched;
  const std::vector<DetectedObject> detections = apart(all, stamp, &matched);
  const std::vector<int> of = associate(detections, stamp);
  // What was taken for one thing from afar turns out to be several.
  for (std::size_t d = 0; d < detections.size(); ++d) {
    for (std::size_t e = 0; e < detections.size() && of[d] < 0; ++e) {
      if (of[e] < 0 || detections[d].furniture || detections[e].furniture) continue;
      ObjectInstance& object = map_.objects[static_cast<std::size_t>(of[e])];
      const bool two = object.pose && isIn(*object.pose, detections[d].centre()) &&
                       isIn(*object.pose, detections[e].centre());
      if (two && !detections[e].cut) object.pose.reset();
    }
  }
  for (std::size_t d = 0; d < detections.size(); ++d) {
    const DetectedObject& seen = detections[d];
    const bool whole = !seen.cut || seen.furniture;
    const auto known = recognise(seen.descriptor, dictionary_);
    const std::string kind = known ? known->name : "";
    if (of[d] >= 0) {
      ObjectInstance& object = map_.objects[static_cast<std::size_t>(of[d])];
      matched.push_back(object.id);
      if (whole) take(&object, seen, kind, stamp);
      continue;
    }
    const bool part = !seen.furniture &&
                      std::any_of(map_.objects.begin(), map_.objects.end(), [&](const auto& o) {
                        return o.pose && isFurniture(o) && isPartOf(*o.pose, seen.centre());
                      });
    if (!whole || part) continue;
    // Told of, but not seen yet: the same kind at the same place.
    Id id = 0;
    if (!kind.empty() && place_at_) {
      const auto here = place_at_(seen.centre().x, seen.centre().y);
      for (const ObjectInstance& object : map_.objects) {
        const ObjectPlace* place = map_.findPlace(map_.placeOf(object.id));
        if (id == 0 && object.told && !object.pose && object.kind == kind && here &&
            place != nullptr && place->name == here->first) {
          id = object.id;
        }
      }
    }
    if (id == 0) id = map_.addObject(seen.furniture ? kFurniture : kUnknown);
    ObjectInstance& object = *map_.find(id);
    if (seen.furniture) object.properties["furniture"] = "yes";
    take(&object, seen, kind, stamp);
    place(id);
    matched.push_back(id);
  }
  missed(cloud, camera, matched, stamp);
  map_.stamp = std::max(map_.stamp, stamp);
}

// Rays of pixels through the middle part of its box: its place is free if nearly all of them end
// behind it. A low thing hides little of what is behind it, so how far behind is not asked, only
// that it is beyond the box by more than the noise. One that is hidden is not missed.
bool ObjectMapper::looksThrough(const OrganisedCloud& cloud, const PinholeCamera& camera,
                                const ObjectPose& pose) const {
  constexpr double kInner = 0.35;  // of the size: corners of a box around a turned thing are empty
  constexpr int kRays = 24, kLeast = 20;
  constexpr double kFree = 0.8, kInFrame = 0.6, kNearest = 0.5, kFarthest = 3.8;
  const Eigen::Vector3d middle(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Vector3d half(kInner * pose.size[0], kInner * pose.size[1], kInner * pose.size[2]);
  const Eigen::Isometry3d map_in_camera = camera.in_map.inverse();
  double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner % 2 * 2 - 1, corner / 2 % 2 * 2 - 1, corner / 4 * 2 - 1);
    const Eigen::Vector3d p = map_in_camera * (middle + half.cwiseProduct(sign)).eval();
    if (p.z() < kNearest || p.z() > kFarthest) return false;
    const double u = camera.focal_length * p.x() / p.z() + camera.cx;
    const double v = camera.focal_length * p.y() / p.z() + camera.cy;
    low_u = std::min(low_u, u), high_u = std::max(high_u, u);
    low_v = std::min(low_v, v), high_v = std::max(high_v, v);
  }
  const double mx = params_.visible_margin * cloud.width,
               my = params_.visible_margin * cloud.height;
  const Eigen::Vector3d eye = camera.in_map.translation() - middle;
  int rays = 0, in_frame = 0, through = 0;
  for (int row = 0; row < kRays; ++row) {
    for (int column = 0; column < kRays; ++column) {
      const double u = low_u + (column + 0.5) / kRays * (high_u - low_u);
      const double v = low_v + (row + 0.5) / kRays * (high_v - low_v);
      const Eigen::Vector3d way =
          camera.in_map.linear() * Eigen::Vector3d((u - camera.cx) / camera.focal_length,
                                                   (v - camera.cy) / camera.focal_length, 1.0);
      double enter = 0.0, leave = 1e9;  // depths
      for (int k = 0; k < 3; ++k) {
        const double step = std::abs(way[k]) > 1e-9 ? way[k] : 1e-9;
        const double one = (-half[k] - eye[k]) / step, two = (half[k] - eye[k]) / step;
        enter = std::max(enter, std::min(one, two));
        leave = std::min(leave, std::max(one, two));
      }
      if (enter >= leave) continue;
      ++rays;
      if (u < mx || v < my || u >= cloud.width - mx || v >= cloud.height - my) continue;
      ++in_frame;
      const Point& measured =
          cloud.points[static_cast<std::size_t>(v) * static_cast<std::size_t>(cloud.width) +
                       static_cast<std::size_t>(u)];
      through += measured.allFinite() && measured.z() > leave + params_.depth_margin;
    }
  }
  return rays >= kLeast && in_frame > kInFrame * rays && through > kFree * in_frame;
}

void ObjectMapper::missed(const OrganisedCloud& cloud, const PinholeCamera& camera,
                          const std::vector<Id>& matched, double stamp) {
  constexpr double kLongAgo = 0.8;  // what was there at the last visit may have gone since
  for (ObjectInstance& object : map_.objects) {
    if (!object.pose || isFurniture(object)) continue;
    if (std::find(matched.begin(), matched.end(), object.id) != matched.end()) continue;
    if (!looksThrough(cloud, camera, *object.pose)) continue;
    if (stamp - object.last_seen > kAbsence)
      object.existence = std::min(object.existence, kLongAgo);
    ++object.missed;
    object.existence = updated(object.existence, false, params_);
  }
}

void ObjectMapper::place(Id id) {
  if (!place_at_) return;
  const ObjectInstance& object = *map_.find(id);
  const Point3& p = object.pose->position;
  const auto here = place_at_(p.x, p.y);
  auto& all = map_.relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [id](const auto& r) { return r.object == id && r.place != 0; }),
            all.end());
  if (!here) return;
  ObjectRelation at;
  at.object = id;
  for (const ObjectPlace& each : map_.places) {
    if (each.name == here->first) at.place = each.id;
  }
  if (at.place == 0) at.place = map_.addPlace(here->first);
  at.vector = Point3{p.x - here->second.x, p.y - here->second.y, p.z - here->second.z};
  at.told = object.told;
  map_.relate(at);
}

void ObjectMapper::merge(Id gone, Id found) {
  ObjectInstance& old = *map_.find(gone);
  ObjectInstance& now = *map_.find(found);
  now.history.insert(now.history.begin(), old.history.begin(), old.history.end());
  now.seen += old.seen;
  now.told = now.told || old.told;
  if (now.kind == kUnknown) now.kind = old.kind;
  now.properties.insert(old.properties.begin(), old.properties.end());
  // The id that others know stays; what was told of where it was does not hold any more.
  ObjectInstance kept = now;
  kept.id = gone;
  auto& all = map_.relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const auto& r) { return r.object == gone || r.other == gone; }),
            all.end());
  keepTold(found, gone);
  map_.remove(found);
  *map_.find(gone) = std::move(kept);
}

// What people have told of one is told of the other.
void ObjectMapper::keepTold(Id from, Id to) {
  std::vector<ObjectRelation> told;
  for (const ObjectRelation& r : map_.relations) {
    if (r.told && (r.object == from || r.other == from)) told.push_back(r);
  }
  for (ObjectRelation& r : told) {
    if (r.object == from) r.object = to;
    if (r.other == from) r.other = to;
    const bool place_known = r.place != 0 && map_.placeOf(to) != 0;
    if (r.object != r.other && !place_known) map_.relate(r);
  }
}

// Of things that look alike it cannot be told which is which; that as many are gone as are new can.
// All are paired at once: the looks of all pairs together decide, then the shortest ways. What was
// seen for the first time soon after the other one was seen for the last time, in a long while that
// nobody looked, was there already: it takes time to be moved.
void ObjectMapper::joinMoved() {
  constexpr double kPerMetre = 1e-3;   // between things that look the same
  constexpr double kLeastShare = 0.2;  // of the time in which it may have been moved
  std::vector<Id> gone, found;
  for (const ObjectInstance& each : map_.objects) {
    if (!each.pose || isFurniture(each)) continue;
    if (each.existence <= kGone && each.seen >= params_.confirm) gone.push_back(each.id);
    if (each.existence >= 0.5 && !each.history.empty()) found.push_back(each.id);
  }
  if (gone.empty() || found.empty()) return;
  std::vector<std::vector<double>> cost;
  for (const Id id : gone) {
    const ObjectInstance& old = *map_.find(id);
    cost.emplace_back();
    for (const Id other : found) {
      const ObjectInstance& now = *map_.find(other);
      const bool later = now.history.front().from - old.last_seen >
                         kLeastShare * std::max(0.0, time_ - old.last_seen);
      const bool other_kind = old.kind != now.kind && old.kind != kUnknown && now.kind != kUnknown;
      const double look = viewDistance(old.descriptor, now.descriptor);
      const bool possible = later && !other_kind && look < params_.refind_look;
      cost.back().push_back(possible ? look + kPerMetre *
                                                  distance(old.pose->position, now.pose->position)
                                     : std::numeric_limits<double>::infinity());
    }
  }
  const double without = 2.0 * params_.refind_look;  // any pair is better than none
  const std::vector<int> of = assignRows(cost, without);
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (of[i] >= 0) merge(gone[i], found[static_cast<std::size_t>(of[i])]);
  }
}

void ObjectMapper::joinFurniture() {
  for (std::size_t i = 0; i < map_.objects.size(); ++i) {
    for (std::size_t j = i + 1; j < map_.objects.size();) {
      ObjectInstance &a = map_.objects[i], &b = map_.objects[j];
      if (!a.pose || !b.pose || !isFurniture(a) || !isFurniture(b) || !isOneTop(*a.pose, *b.pose)) {
        ++j;
        continue;
      }
      unite(&*a.pose, *b.pose);
      a.seen += b.seen;
      a.told = a.told || b.told;
      keepTold(b.id, a.id);
      map_.remove(b.id);
      j = i + 1;
    }
  }
}

// Whether two things of one kind touch and are together no larger than one of that kind.
bool ObjectMapper::areFacesOfOne(const ObjectInstance& a, const ObjectInstance& b) const {
  constexpr double kGap = 0.03, kDeviations = 3.0;
  if (a.kind != b.kind) return false;
  const GenericObject* kind = dictionary_.find(a.kind);
  if (kind == nullptr || !(kind->shape.size[0] > 0.0)) return false;
  ObjectPose both = *a.pose;
  unite(&both, *b.pose);
  const double most = std::max(both.size[0], both.size[1]);
  if (most > kind->shape.size[0] + kDeviations * kind->shape.spread[0] + params_.sigma ||
      both.size[2] > kind->shape.size[2] + kDeviations * kind->shape.spread[2] + params_.sigma) {
    return false;
  }
  return both.size[0] < a.pose->size[0] + b.pose->size[0] + kGap &&
         both.size[1] < a.pose->size[1] + b.pose->size[1] + kGap;
}

// Two views that were too different to be taken for one thing.
void ObjectMapper::joinTwins() {
  for (std::size_t i = 0; i < map_.objects.size(); ++i) {
    for (std::size_t j = i + 1; j < map_.objects.size();) {
      ObjectInstance &a = map_.objects[i], &b = map_.objects[j];
      const bool things = a.pose && b.pose && !isFurniture(a) && !isFurniture(b);
      const bool faces = things && areFacesOfOne(a, b);
      if (!things || std::abs(a.last_seen - b.last_seen) > kAbsence ||
          (!faces && !isSameSpot(*a.pose, *b.pose))) {
        ++j;
        continue;
      }
      if (faces) {
        unite(&*a.pose, *b.pose);
        b.pose = a.pose;
      }
      const bool second = b.pose->size[2] > 1.4 * a.pose->size[2] || b.seen > 2 * a.seen;
      if (second) {
        a.pose = b.pose;
        a.descriptor = b.descriptor;
        if (b.kind != kUnknown) a.kind = b.kind;
      }
      if (a.kind == kUnknown) a.kind = b.kind;
      a.seen += b.seen;
      a.last_seen = std::max(a.last_seen, b.last_seen);
      a.existence = std::max(a.existence, b.existence);
      a.told = a.told || b.told;
      keepTold(b.id, a.id);
      map_.remove(b.id);
      j = i + 1;
    }
  }
}

// Parts of a thing, and several things in one, that were seen now and then.
bool ObjectMapper::isShadow(const ObjectInstance& object) const {
  constexpr double kMargin = 0.03;
  int within = 0;
  for (const ObjectInstance& other : map_.objects) {
    if (other.id == object.id || !other.pose || isFurniture(other) || isFurniture(object)) continue;
    if (other.existence < 0.5) continue;
    // Two bodies are not in one place: of the same kind, one is a face of the other.
    const bool alike = object.kind == other.kind || object.kind == kUnknown;
    if (alike && object.seen <= other.seen && shareWithin(*object.pose, *other.pose) > 0.8 &&
        shareWithin(*other.pose, *object.pose) < 0.8) {
      return true;
    }
    if (2 * object.seen > other.seen) continue;
    const double away = std::abs(object.pose->position.z - other.pose->position.z);
    if (isOn(*other.pose, object.pose->position) && away < 0.5 * other.pose->size[2] + kMargin) {
      return true;
    }
    within += isIn(*object.pose, other.pose->position);
  }
  return within >= 2;
}

void ObjectMapper::finish(double weak_before) {
  joinFurniture();
  dropTopsOfThings();
  joinTwins();
  joinMoved();
  std::vector<Id> dropped;
  for (const ObjectInstance& object : map_.objects) {
    if (!object.pose || object.told) continue;
    bool weak =
        (object.seen < params_.confirm && object.last_seen < weak_before) || isShadow(object);
    for (const ObjectInstance& other : map_.objects) {
      weak = weak || (other.pose && isFurniture(other) && !isFurniture(object) &&
                      isPartOf(*other.pose, object.pose->position));
    }
    const bool doubtful = object.missed > object.seen && object.existence < 0.5;
    if (weak || doubtful) dropped.push_back(object.id);
  }
  for (const Id id : dropped) map_.remove(id);
  for (const ObjectInstance& object : map_.objects) {
    if (object.pose) place(object.id);
  }
  updateRelations(&map_, params_.relations);
  for (ObjectRelation& relation : map_.relations) {
    relation.movability = movability(map_, relation.object, params_.movability);
  }
}

}  // namespace hyselam_objects

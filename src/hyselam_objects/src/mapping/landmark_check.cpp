#include "hyselam_objects/mapping/landmark_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hyselam_objects/mapping/object_relations.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"
#include "instance_traits.hpp"

namespace hyselam_objects {
namespace {

constexpr double kMaxChi2 = 9.0;  // of an object without a landmark nearby: 3 sigma

struct Offset {
  double x = 0.0, y = 0.0;
};

struct Landmark {
  std::array<double, 2> low, high, middle;
};

/// A detection and the landmarks that it may be.
struct ComparedObject {
  bool furniture = false;
  std::array<double, 2> low, high, middle;
  std::vector<Landmark> candidates;
};

/// Distance of a detection from a landmark with the offset applied, along one axis [m].
double axisDistance(const ComparedObject& object, const Landmark& landmark, std::size_t axis,
                    double offset) {
  if (!object.furniture) return object.middle[axis] + offset - landmark.middle[axis];
  // A part of a piece of furniture is detections: by how much it sticks out.
  const double low = landmark.low[axis] - (object.low[axis] + offset);
  const double high = object.high[axis] + offset - landmark.high[axis];
  return std::max({0.0, low, high});
}

class Comparison {
 public:
  Comparison(const std::vector<ComparedObject>& objects, double sigma)
      : objects_(objects), sigma_(sigma) {}

  double chi2Of(const ComparedObject& object, const Offset& offset) const {
    double chi2 = kMaxChi2;
    for (const Landmark& landmark : object.candidates) {
      const double x = axisDistance(object, landmark, 0, offset.x),
                   y = axisDistance(object, landmark, 1, offset.y);
      chi2 = std::min(chi2, (x * x + y * y) / (sigma_ * sigma_));
    }
    return chi2;
  }
  double sumOfChi2(const Offset& offset) const {
    double all = 0.0;
    for (const ComparedObject& object : objects_) all += chi2Of(object, offset);
    return all;
  }
  int inliers(const Offset& offset) const {
    return static_cast<int>(std::count_if(
        objects_.begin(), objects_.end(),
        [&](const ComparedObject& object) { return chi2Of(object, offset) < kMaxChi2; }));
  }
  /// Corrected by the mean residual of the inliers, repeatedly.
  Offset refined(Offset offset) const {
    constexpr int kIterations = 5;
    for (int i = 0; i < kIterations; ++i) {
      double x = 0.0, y = 0.0;
      int all = 0;
      for (const ComparedObject& object : objects_) {
        if (object.furniture) continue;
        for (const Landmark& landmark : object.candidates) {
          const double dx = axisDistance(object, landmark, 0, offset.x),
                       dy = axisDistance(object, landmark, 1, offset.y);
          if (dx * dx + dy * dy >= kMaxChi2 * sigma_ * sigma_) continue;
          x += dx, y += dy;
          ++all;
        }
      }
      if (all == 0) break;
      offset.x -= x / all;
      offset.y -= y / all;
    }
    return offset;
  }

 private:
  const std::vector<ComparedObject>& objects_;
  double sigma_;
};

std::vector<ComparedObject> comparableObjects(const ObjectMap& map,
                                              const std::vector<DetectedObject>& detections,
                                              const LandmarkParams& params) {
  std::vector<const ObjectInstance*> landmarks;
  for (const ObjectInstance& each : map.objects) {
    const bool stays =
        isFurniture(each) || static_cast<int>(each.history.size()) >= params.min_visits;
    if (each.pose && stays && each.existence > 0.5 && each.detections >= params.min_views &&
        movability(map, each.id) <= params.max_movability) {
      landmarks.push_back(&each);
    }
  }
  std::vector<ComparedObject> objects;
  for (const DetectedObject& each : detections) {
    if (each.partial && !each.furniture) continue;
    ComparedObject object;
    object.furniture = each.furniture;
    object.low = {each.low.x, each.low.y};
    object.high = {each.high.x, each.high.y};
    const Point3 c = each.center();
    object.middle = {c.x, c.y};
    for (const ObjectInstance* known : landmarks) {
      const ObjectPose& pose = *known->pose;
      if (isFurniture(*known) != each.furniture) continue;
      const double height = pose.position.z + 0.5 * pose.size[2] - each.high.z;
      constexpr double kMaxHeightDifference = 0.08;  // of the tops [m]
      if (std::abs(height) > kMaxHeightDifference) continue;
      if (!each.furniture &&
          descriptorDistance(known->descriptor, each.descriptor) > params.appearance_threshold) {
        continue;
      }
      // Of a box that is turned the one around it.
      const double along = std::abs(std::cos(pose.yaw)), across = std::abs(std::sin(pose.yaw));
      const double x = 0.5 * (along * pose.size[0] + across * pose.size[1]),
                   y = 0.5 * (across * pose.size[0] + along * pose.size[1]);
      object.candidates.push_back({{pose.position.x - x, pose.position.y - y},
                                   {pose.position.x + x, pose.position.y + y},
                                   {pose.position.x, pose.position.y}});
    }
    if (!object.candidates.empty()) objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace

const char* toString(LandmarkVerdict verdict) {
  constexpr std::array<const char*, 4> kNames{"unknown", "consistent", "displaced", "doubtful"};
  return kNames.at(static_cast<std::size_t>(verdict));
}

void LandmarkParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("max_movability", max_movability, Range::between(0.0, 1.0), "", "of a landmark");
  visit("min_views", min_views, Range::atLeast(0), "", "number of views of a landmark");
  visit("min_visits", min_visits, Range::atLeast(0), "",
        "number of stays in the history of a landmark that is not furniture");
  visit("appearance_threshold", appearance_threshold, Range::atLeast(0.0), "",
        "largest distance of the descriptors of an object and its landmark");
  visit("position_sigma", position_sigma, Range::above(0.0), "m",
        "standard deviation of an object's position, small errors of the pose included");
  visit("max_offset", max_offset, Range::above(0.0), "m",
        "largest offset of the pose that is searched for");
  visit("min_compared", min_compared, Range::atLeast(1), "",
        "number of objects with a landmark that a verdict needs");
  visit("min_chi2_gain", min_chi2_gain, Range::atLeast(0.0), "",
        "by which an offset must reduce the sum of truncated chi^2");
  visit("min_offset", min_offset, Range::atLeast(0.0), "m", "smaller offsets are not reported");
}

void LandmarkParams::validate() const {
  hyselam::checkParameters(*this);
}

LandmarkCheck checkLandmarks(const ObjectMap& map, const std::vector<DetectedObject>& detections,
                             const LandmarkParams& params) {
  params.validate();
  const std::vector<ComparedObject> objects = comparableObjects(map, detections, params);
  const Comparison comparison(objects, params.position_sigma);
  LandmarkCheck out;
  out.compared = static_cast<int>(objects.size());
  if (out.compared < params.min_compared) return out;
  const double chi2 = comparison.sumOfChi2({});
  Offset best;
  double lowest = chi2;
  const auto consider = [&](const Offset& offset) {
    if (std::hypot(offset.x, offset.y) > params.max_offset) return;
    const double sum = comparison.sumOfChi2(offset);
    if (sum >= lowest) return;
    lowest = sum;
    best = offset;
  };
  for (const ComparedObject& object : objects) {
    for (const Landmark& known : object.candidates) {
      consider({known.middle[0] - object.middle[0], known.middle[1] - object.middle[1]});
      if (!object.furniture) continue;
      consider({known.low[0] - object.low[0], known.low[1] - object.low[1]});
      consider({known.high[0] - object.high[0], known.high[1] - object.high[1]});
    }
  }
  consider(comparison.refined(best));
  out.chi2 = chi2 / out.compared;
  out.inliers = comparison.inliers({});
  out.chi2_with_offset = out.chi2;
  constexpr int kMinInliers = 2;
  const bool most_fit = 2 * comparison.inliers(best) > out.compared;
  if (chi2 - lowest > params.min_chi2_gain && std::hypot(best.x, best.y) > params.min_offset &&
      most_fit && comparison.inliers(best) >= kMinInliers) {
    out.verdict = LandmarkVerdict::kDisplaced;
    out.chi2_with_offset = lowest / out.compared;
    out.inliers = comparison.inliers(best);
    out.x = best.x;
    out.y = best.y;
  } else {
    out.verdict =
        2 * out.inliers > out.compared ? LandmarkVerdict::kConsistent : LandmarkVerdict::kDoubtful;
  }
  return out;
}

LandmarkCheck LandmarkMonitor::add(const ObjectMap& map,
                                   const std::vector<DetectedObject>& detections) {
  last_.push_back(detections);
  if (last_.size() > frames_) last_.pop_front();
  std::vector<DetectedObject> all;
  for (const auto& each : last_) all.insert(all.end(), each.begin(), each.end());
  return checkLandmarks(map, all, params_);
}

bool MapUpdateGuard::allowsUpdate(const ObjectMap& map,
                                  const std::vector<DetectedObject>& detections) {
  constexpr int kMaxHeldBack = 20;  // frames
  last_check_ = monitor_.add(map, detections);
  const bool contradicts = last_check_.verdict == LandmarkVerdict::kDisplaced ||
                           last_check_.verdict == LandmarkVerdict::kDoubtful;
  held_back_ = contradicts ? held_back_ + 1 : 0;
  if (held_back_ > kMaxHeldBack) {
    monitor_.clear();
    held_back_ = 0;
  }
  return held_back_ == 0;
}

}  // namespace hyselam_objects

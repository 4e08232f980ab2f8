#include "hyselam_objects/landmark_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hyselam_common/require.hpp"
#include "hyselam_objects/object_descriptor.hpp"
#include "hyselam_objects/object_relations.hpp"
#include "instance_traits.hpp"

namespace hyselam_objects {
namespace {

constexpr double kMost = 9.0;  // chi^2 of what fits nowhere

struct Offset {
  double x = 0.0, y = 0.0;
};

struct Landmark {
  std::array<double, 2> low, high, middle;
};

/// Something seen and the landmarks that it may be.
struct Sight {
  bool furniture = false;
  std::array<double, 2> low, high, middle;
  std::vector<Landmark> of;
};

/// How far a thing with an offset is from a landmark, along one axis.
double away(const Sight& sight, const Landmark& landmark, std::size_t axis, double offset) {
  if (!sight.furniture) return sight.middle[axis] + offset - landmark.middle[axis];
  // A part of it is seen: that sticks out by so much.
  const double low = landmark.low[axis] - (sight.low[axis] + offset);
  const double high = sight.high[axis] + offset - landmark.high[axis];
  return std::max({0.0, low, high});
}

class Comparison {
 public:
  Comparison(const std::vector<Sight>& sights, double sigma) : sights_(sights), sigma_(sigma) {}

  double chi2Of(const Sight& sight, const Offset& offset) const {
    double least = kMost;
    for (const Landmark& landmark : sight.of) {
      const double x = away(sight, landmark, 0, offset.x), y = away(sight, landmark, 1, offset.y);
      least = std::min(least, (x * x + y * y) / (sigma_ * sigma_));
    }
    return least;
  }
  double sum(const Offset& offset) const {
    double all = 0.0;
    for (const Sight& sight : sights_) all += chi2Of(sight, offset);
    return all;
  }
  int fitting(const Offset& offset) const {
    return static_cast<int>(std::count_if(sights_.begin(), sights_.end(), [&](const Sight& sight) {
      return chi2Of(sight, offset) < kMost;
    }));
  }
  /// The mean of what is left of the things that fit.
  Offset refined(Offset offset) const {
    for (int i = 0; i < 5; ++i) {
      double x = 0.0, y = 0.0;
      int all = 0;
      for (const Sight& sight : sights_) {
        if (sight.furniture) continue;
        for (const Landmark& landmark : sight.of) {
          const double dx = away(sight, landmark, 0, offset.x),
                       dy = away(sight, landmark, 1, offset.y);
          if (dx * dx + dy * dy >= kMost * sigma_ * sigma_) continue;
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
  const std::vector<Sight>& sights_;
  double sigma_;
};

std::vector<Sight> sightsOf(const ObjectMap& map, const std::vector<DetectedObject>& seen,
                            const LandmarkParams& params) {
  std::vector<const ObjectInstance*> landmarks;
  for (const ObjectInstance& each : map.objects) {
    const bool stays = isFurniture(each) || static_cast<int>(each.history.size()) >= params.visits;
    if (each.pose && stays && each.existence > 0.5 && each.seen >= params.seen &&
        movability(map, each.id) <= params.movable) {
      landmarks.push_back(&each);
    }
  }
  std::vector<Sight> sights;
  for (const DetectedObject& each : seen) {
    if (each.cut && !each.furniture) continue;
    Sight sight;
    sight.furniture = each.furniture;
    sight.low = {each.low.x, each.low.y};
    sight.high = {each.high.x, each.high.y};
    const Point3 c = each.center();
    sight.middle = {c.x, c.y};
    for (const ObjectInstance* known : landmarks) {
      const ObjectPose& pose = *known->pose;
      if (isFurniture(*known) != each.furniture) continue;
      const double height = pose.position.z + 0.5 * pose.size[2] - each.high.z;
      constexpr double kHeight = 0.08;
      if (std::abs(height) > kHeight) continue;
      if (!each.furniture && viewDistance(known->descriptor, each.descriptor) > params.look) {
        continue;
      }
      sight.of.push_back(
          {{pose.position.x - 0.5 * pose.size[0], pose.position.y - 0.5 * pose.size[1]},
           {pose.position.x + 0.5 * pose.size[0], pose.position.y + 0.5 * pose.size[1]},
           {pose.position.x, pose.position.y}});
    }
    if (!sight.of.empty()) sights.push_back(std::move(sight));
  }
  return sights;
}

}  // namespace

const char* toString(LandmarkVerdict verdict) {
  constexpr std::array<const char*, 4> kNames{"unknown", "consistent", "displaced", "doubtful"};
  return kNames.at(static_cast<std::size_t>(verdict));
}

LandmarkCheck checkLandmarks(const ObjectMap& map, const std::vector<DetectedObject>& seen,
                             const LandmarkParams& params) {
  hyselam::require("sigma", params.sigma, params.sigma > 0.0, "> 0");
  hyselam::require("search", params.search, params.search > 0.0, "> 0");
  const std::vector<Sight> sights = sightsOf(map, seen, params);
  const Comparison comparison(sights, params.sigma);
  LandmarkCheck out;
  out.compared = static_cast<int>(sights.size());
  if (out.compared < params.at_least) return out;
  const double believed = comparison.sum({});
  Offset best;
  double least = believed;
  const auto consider = [&](const Offset& offset) {
    if (std::hypot(offset.x, offset.y) > params.search) return;
    const double sum = comparison.sum(offset);
    if (sum >= least) return;
    least = sum;
    best = offset;
  };
  for (const Sight& sight : sights) {
    for (const Landmark& known : sight.of) {
      consider({known.middle[0] - sight.middle[0], known.middle[1] - sight.middle[1]});
      if (!sight.furniture) continue;
      consider({known.low[0] - sight.low[0], known.low[1] - sight.low[1]});
      consider({known.high[0] - sight.high[0], known.high[1] - sight.high[1]});
    }
  }
  consider(comparison.refined(best));
  out.chi2 = believed / out.compared;
  out.fitting = comparison.fitting({});
  out.chi2_with_offset = out.chi2;
  const bool most_fit = 2 * comparison.fitting(best) > out.compared;
  if (believed - least > params.worth && std::hypot(best.x, best.y) > params.least && most_fit &&
      comparison.fitting(best) >= 2) {
    out.verdict = LandmarkVerdict::kDisplaced;
    out.chi2_with_offset = least / out.compared;
    out.fitting = comparison.fitting(best);
    out.x = best.x;
    out.y = best.y;
  } else {
    out.verdict =
        2 * out.fitting > out.compared ? LandmarkVerdict::kConsistent : LandmarkVerdict::kDoubtful;
  }
  return out;
}

LandmarkCheck LandmarkWatch::add(const ObjectMap& map, const std::vector<DetectedObject>& seen) {
  last_.push_back(seen);
  if (last_.size() > frames_) last_.pop_front();
  std::vector<DetectedObject> all;
  for (const auto& each : last_) all.insert(all.end(), each.begin(), each.end());
  return checkLandmarks(map, all, params_);
}

}  // namespace hyselam_objects

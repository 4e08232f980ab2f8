#include "ngram_slam/slam/redundant_keyframes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "hyselam_scan_matching/surface_map.hpp"
#include "ngram_slam/slam/keyframe_grid.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam_scan_matching::SurfaceMap;
using hyselam_scan_matching::SurfacePoint;

namespace {

constexpr double kAllRound = 0.9 * 2.0 * hyselam::kPi;  // [rad] no look of its own
constexpr double kSurfaceCell = 0.05;                   // [m] of the map of the surroundings

double fieldOfView(const hyselam::LaserScan& scan) {
  return std::abs(scan.angle_increment) * static_cast<double>(scan.ranges.size());
}

/// Beams hit a surface this far apart at least [m].
double spacingAt(double range, const hyselam::LaserScan& scan) {
  return range * std::abs(scan.angle_increment);
}

/// Of the points of a keyframe, the part that lies on known surfaces; 1 if it has none.
double explainedPart(const SlamKeyframe& k, const SurfaceMap& known, double surface_distance) {
  if (k.points->empty()) return 1.0;
  const auto count = std::count_if(k.points->begin(), k.points->end(), [&](const SurfacePoint& p) {
    const double radius = surface_distance + spacingAt(std::hypot(p.x, p.y), *k.scan);
    return known.nearest(p, radius) != nullptr;
  });
  return static_cast<double>(count) / static_cast<double>(k.points->size());
}

/// The nearest and the farthest return of the beams on both sides of a bearing; nothing where one
/// of them has none.
struct Returns {
  double nearest, farthest;
};
std::optional<Returns> returnsAround(double bearing, const hyselam::LaserScan& scan) {
  constexpr std::ptrdiff_t kBefore = 1, kBehind = 2;  // two on each side: headings are not exact
  const double step = std::abs(scan.angle_increment);
  double turn = (bearing - scan.angle_min) * (scan.angle_increment < 0.0 ? -1.0 : 1.0);
  turn -= 2.0 * hyselam::kPi * std::floor(turn / (2.0 * hyselam::kPi));
  const auto beam = static_cast<std::ptrdiff_t>(turn / step);
  if (beam < kBefore || beam + kBehind >= static_cast<std::ptrdiff_t>(scan.ranges.size()))
    return {};
  Returns found{std::numeric_limits<double>::infinity(), 0.0};
  for (auto i = beam - kBefore; i <= beam + kBehind; ++i) {
    const auto range = static_cast<double>(scan.ranges[static_cast<std::size_t>(i)]);
    if (!(range >= scan.range_min && range < scan.range_max)) return {};
    found.nearest = std::min(found.nearest, range);
    found.farthest = std::max(found.farthest, range);
  }
  return found;
}

/// Of the known surfaces that a scan should see, the part that it does see; the rest it sees
/// through. 1 if it should see none. Beams are compared, not cells: along a wall that is seen under
/// a small angle a beam passes free cells beside every one of its points.
double seenAgainPart(const hyselam::LaserScan& scan,
                     const hyselam_scan_matching::SurfacePoints& known, double surface_distance) {
  if (scan.angle_increment == 0.0) return 1.0;
  const hyselam::Pose2 base_in_laser = scan.laser_in_base.inverse();
  std::size_t seen = 0, missed = 0;
  for (const SurfacePoint& p : known) {
    const hyselam::Point2 q = base_in_laser * hyselam::Point2{p.x, p.y};
    const double range = std::hypot(q.x, q.y);
    const double margin = surface_distance + spacingAt(range, scan);
    const auto returns = returnsAround(std::atan2(q.y, q.x), scan);
    if (!returns || range > returns->farthest + margin) continue;  // hidden
    ++(returns->nearest > range + margin ? missed : seen);
  }
  return seen + missed == 0 ? 1.0 : static_cast<double>(seen) / static_cast<double>(seen + missed);
}

class Thinning {
 public:
  Thinning(const std::vector<SlamKeyframe>& keyframes, const std::vector<int>& components,
           const std::vector<bool>& fixed, const RedundancyParams& params)
      : keyframes_(keyframes),
        components_(components),
        fixed_(fixed),
        params_(params),
        grid_(keyframes, std::max(params.place_radius, params.surroundings_radius)),
        dropped_(keyframes.size(), false) {}

  /// Judges all keyframes once. Returns whether some are dropped now.
  bool judgeAll() {
    bool found = false;
    for (int k = 0; k < static_cast<int>(keyframes_.size()); ++k) {
      if (!dropped_[static_cast<std::size_t>(k)] && judge(k)) found = true;
    }
    return found;
  }
  std::vector<bool> take() { return std::move(dropped_); }

 private:
  struct Near {
    int keyframe;
    double distance;
  };

  const SlamKeyframe& at(int k) const { return keyframes_[static_cast<std::size_t>(k)]; }
  bool isFixed(int k) const { return fixed_[static_cast<std::size_t>(k)]; }

  bool looksTheSameWay(const SlamKeyframe& a, const SlamKeyframe& b) const {
    if (std::min(fieldOfView(*a.scan), fieldOfView(*b.scan)) >= kAllRound) return true;
    return std::abs(hyselam::normalizeAngle(a.pose.theta - b.pose.theta)) <= params_.look_angle;
  }

  /// What earlier runs left around a keyframe, looking the same way; the nearest first.
  std::vector<Near> earlierLooks(int k) const {
    std::vector<Near> found;
    const auto here = static_cast<std::size_t>(k);
    const double radius = std::max(params_.place_radius, params_.surroundings_radius);
    grid_.forEachNear(at(k).pose, radius, [&](int other, double distance) {
      const auto there = static_cast<std::size_t>(other);
      if (!dropped_[there] && at(other).run < at(k).run &&
          components_[there] == components_[here] && looksTheSameWay(at(other), at(k))) {
        found.push_back({other, distance});
      }
    });
    std::sort(found.begin(), found.end(), [](const Near& a, const Near& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.keyframe < b.keyframe;
    });
    return found;
  }

  /// Drops a keyframe that others explain, or an old one where too many do not.
  bool judge(int k) {
    const std::vector<Near> looks = earlierLooks(k);
    if (looks.empty() || looks.front().distance >= params_.place_radius) return false;
    if (!isFixed(k) && isExplained(k, looks)) {
      dropped_[static_cast<std::size_t>(k)] = true;
      return true;
    }
    return dropSecondRun(k, looks);
  }

  /// Too many runs have been here that no other explains. The first one stays, as all others were
  /// laid on it: without it the map would walk from visit to visit. What the second one saw is no
  /// news.
  bool dropSecondRun(int k, const std::vector<Near>& looks) {
    std::set<std::uint32_t> runs = {at(k).run};
    for (const Near& n : looks) {
      if (n.distance < params_.place_radius) runs.insert(at(n.keyframe).run);
    }
    if (static_cast<int>(runs.size()) <= params_.max_looks) return false;
    const std::uint32_t goes = *std::next(runs.begin());
    bool found = goes == at(k).run && !isFixed(k);
    if (found) dropped_[static_cast<std::size_t>(k)] = true;
    for (const Near& n : looks) {
      if (n.distance >= params_.place_radius || at(n.keyframe).run != goes || isFixed(n.keyframe)) {
        continue;
      }
      dropped_[static_cast<std::size_t>(n.keyframe)] = true;
      found = true;
    }
    return found;
  }

  /// Whether what the scan saw is known, and what is known there was seen again.
  bool isExplained(int k, const std::vector<Near>& looks) const {
    const SlamKeyframe& here = at(k);
    SurfaceMap map(kSurfaceCell);
    const auto count =
        std::min(looks.size(), static_cast<std::size_t>(params_.surroundings_keyframes));
    for (std::size_t i = 0; i < count; ++i) {
      if (looks[i].distance >= params_.surroundings_radius) break;
      const SlamKeyframe& other = at(looks[i].keyframe);
      map.insert(between(here.pose, other.pose), *other.points);
    }
    map.finish();
    return explainedPart(here, map, params_.surface_distance) >= params_.min_explained &&
           seenAgainPart(*here.scan, map.points(), params_.surface_distance) >=
               params_.min_seen_again;
  }

  const std::vector<SlamKeyframe>& keyframes_;
  const std::vector<int>& components_;
  const std::vector<bool>& fixed_;
  const RedundancyParams& params_;
  KeyframeGrid grid_;
  std::vector<bool> dropped_;
};

}  // namespace

void RedundancyParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  const Range ratio = Range::between(0.0, 1.0), positive = Range::above(0.0),
              count = Range::between(1, 1e6);
  visit("place_radius", place_radius, positive, "m", "keyframes this near are at the same place");
  visit("look_angle", look_angle, Range::between(0.0, hyselam::kPi), "rad",
        "up to this turn lasers that do not see all around look the same way");
  visit("surroundings_radius", surroundings_radius, positive, "m",
        "of the keyframes whose surfaces explain a scan");
  visit("surroundings_keyframes", surroundings_keyframes, count, "", "the nearest of them");
  visit("surface_distance", surface_distance, positive, "m",
        "a point this near to a surface is explained by it");
  visit("min_explained", min_explained, ratio, "",
        "part of the points of a keyframe that is explained, for it to be dropped");
  visit("min_seen_again", min_seen_again, ratio, "",
        "part of the known surfaces in its view that it does not see through");
  visit("max_looks", max_looks, count, "",
        "runs that one place and direction is kept of where they saw different things: the first "
        "and the newest");
}

std::vector<bool> redundantKeyframes(const std::vector<SlamKeyframe>& keyframes,
                                     const std::vector<int>& components,
                                     const std::vector<bool>& fixed,
                                     const RedundancyParams& params) {
  Thinning thinning(keyframes, components, fixed, params);
  // What is dropped may have been what contradicted another.
  while (thinning.judgeAll()) {
  }
  return thinning.take();
}

}  // namespace ngram_slam

#include "ngram_slam/slam/loop_verifier.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "ngram_slam/slam/segment_context.hpp"

namespace ngram_slam {

namespace {

using hyselam_scan_matching::CorrelativeMatch;
using hyselam_scan_matching::CorrelativeMatcher;
using hyselam_scan_matching::CorrelativeMatcherParams;
using hyselam_scan_matching::IcpResult;
using hyselam_scan_matching::SurfaceMap;
using hyselam_scan_matching::SurfacePoints;

// A far search scores points up to this many cells from a surface.
constexpr double kFarInlierCells = 3.0;
// Of the surroundings that tell how two segments are turned to each other.
constexpr double kContextHalfLength = 5.0;  // [m]
constexpr double kContextCell = 0.2;        // [m]
constexpr std::size_t kTurns = 2;           // that are tried

/// Every n-th point, so that about `max_points` remain.
SurfacePoints thinned(const SurfacePoints& points, int max_points) {
  const auto max_size = static_cast<std::size_t>(max_points);
  const std::size_t step = std::max<std::size_t>(1, points.size() / max_size);
  SurfacePoints few;
  for (std::size_t i = 0; i < points.size(); i += step) few.push_back(points[i]);
  return few;
}

SurfaceMap mapOf(const LoopTask::Segment& segment, double cell) {
  SurfaceMap map(cell);
  for (const LoopTask::PosedScan& s : segment) map.insert(s.pose, *s.points);
  map.finish();
  return map;
}

ObservedSpace observedSpaceOf(const LoopTask::Segment& segment, const LoopParams& p) {
  ObservedSpace space(p.observed_space_side, p.far_resolution);
  for (const LoopTask::PosedScan& s : segment) space.insert(s.pose, *s.points, s.laser);
  return space;
}

/// The points of the new segment in the frame of `newer`.
SurfacePoints newPoints(const LoopTask& task, const LoopParams& p) {
  if (task.far) return mapOf(task.new_segment, 0.5 * p.far_resolution).points();
  if (task.new_segment.empty()) return {};
  return transformed(task.new_segment[0].pose, *task.new_segment[0].points);
}

/// Cells as coarse as those of a place's context, around the keyframe that the segment belongs to.
SurfacePoints pointsAround(const LoopTask::Segment& segment) {
  LoopTask::Segment near;
  for (const LoopTask::PosedScan& s : segment) {
    if (std::hypot(s.pose.x, s.pose.y) <= kContextHalfLength) near.push_back(s);
  }
  return mapOf(near, kContextCell).points();
}

/// Where the new segment is searched, until it is found.
std::vector<hyselam::Pose2> guessesOf(const LoopTask& task) {
  if (!task.any_heading) return {task.initial_guess};
  std::vector<hyselam::Pose2> guesses;
  for (const double turn :
       likelyTurns(pointsAround(task.old_segment), pointsAround(task.new_segment), kTurns)) {
    guesses.push_back({task.initial_guess.x, task.initial_guess.y, turn});
  }
  return guesses;
}

CorrelativeMatcherParams searchParams(const LoopTask& task, const LoopParams& p) {
  CorrelativeMatcherParams s;
  s.linear_window = task.window;
  s.angular_window = task.angle;
  s.min_score = task.far ? p.far_min_score : p.near_min_score;
  s.resolution = task.far ? p.far_resolution : p.near_resolution;
  s.max_distance = task.far ? kFarInlierCells * p.far_resolution : p.near_inlier_distance;
  return s;
}

/// The best pose around a guess, nothing if there is none or, for a far loop, an ambiguous one.
std::optional<CorrelativeMatch> searchUnambiguousPose(const LoopTask& task, const LoopParams& p,
                                                      const CorrelativeMatcher& grid,
                                                      const SurfacePoints& points,
                                                      const hyselam::Pose2& guess,
                                                      LoopVerification* answer) {
  const auto found = grid.match(points, guess);
  if (!found) return std::nullopt;
  answer->score = found->score;
  if (task.far && p.max_ambiguity_ratio < 1.0) {
    const auto other = grid.secondBest(points, guess, found->pose, p.ambiguity_distance,
                                       p.max_ambiguity_ratio * found->score);
    if (other) {
      answer->ambiguous_score = other->score;
      return std::nullopt;
    }
  }
  return found;
}

/// Puts the refined pose and its information into the loop.
void refineLoop(const LoopTask& task, const SlamParams& params, const SurfaceMap& old_map,
                const SurfacePoints& points, const hyselam::Pose2& pose, SlamLoop* loop) {
  const SurfacePoints many =
      task.far ? thinned(points, params.loop.far_max_refined_points) : points;
  const IcpResult r = alignIcp(many, old_map, pose, Eigen::Matrix3d::Zero(), params.refine);
  loop->measured = r.pose;
  loop->inlier_ratio = r.matched;
  // A segment of many scans counts no more than one of them: the errors within it are its own.
  double scale = 1.0;
  if (task.far) {
    const std::size_t scans = std::max<std::size_t>(1, task.new_segment.size());
    scale = std::min(1.0,
                     static_cast<double>(points.size()) / static_cast<double>(many.size() * scans));
  }
  loop->information =
      params.scan_information_scale * scale * r.information + Eigen::Matrix3d::Identity();
  loop->information = (0.5 * (loop->information + loop->information.transpose())).eval();
}

/// What both segments observed, made when it is needed.
struct BothSpaces {
  std::optional<ObservedSpace> of_old, of_new;

  void make(const LoopTask& task, const LoopParams& p) {
    if (of_old) return;
    of_old = observedSpaceOf(task.old_segment, p);
    of_new = observedSpaceOf(task.new_segment, p);
  }
};

/// Refines the pose found, and judges it.
void judgePose(const LoopTask& task, const SlamParams& params, const SurfaceMap& old_map,
               const SurfacePoints& points, const hyselam::Pose2& pose, BothSpaces* spaces,
               LoopVerification* answer) {
  const LoopParams& p = params.loop;
  SlamLoop& loop = answer->loop;
  refineLoop(task, params, old_map, points, pose, &loop);
  if (loop.inlier_ratio < (task.far ? p.far_min_inlier_ratio : p.near_min_inlier_ratio)) return;
  // Neither segment may have surfaces where the other observed free space.
  spaces->make(task, p);
  answer->new_in_old = spaces->of_old->overlap(loop.measured, points);
  answer->old_in_new = spaces->of_new->overlap(loop.measured.inverse(), old_map.points());
  loop.fit = std::min(answer->new_in_old.surface_ratio, answer->old_in_new.surface_ratio);
  const double min_ratio = task.far ? p.far_min_surface_ratio : p.near_min_surface_ratio;
  answer->verified = answer->new_in_old.observed_ratio >= p.min_overlap && loop.fit >= min_ratio;
}

}  // namespace

LoopVerification verifyLoop(const LoopTask& task, const SlamParams& params) {
  LoopVerification empty;
  empty.loop.older = task.older;
  empty.loop.newer = task.newer;
  empty.loop.source = task.source;
  empty.loop.far = task.far;
  const LoopParams& p = params.loop;
  const SurfaceMap old_map = mapOf(task.old_segment, params.local_map_resolution);
  const SurfacePoints points = newPoints(task, p);
  if (points.empty() || old_map.empty()) return empty;

  const CorrelativeMatcher grid(old_map, searchParams(task, p));
  const SurfacePoints few = thinned(points, task.far ? p.far_max_points : p.near_max_points);
  BothSpaces spaces;
  LoopVerification best = empty;
  for (const hyselam::Pose2& guess : guessesOf(task)) {
    LoopVerification answer = empty;
    const auto found = searchUnambiguousPose(task, p, grid, few, guess, &answer);
    if (found) judgePose(task, params, old_map, points, found->pose, &spaces, &answer);
    if (answer.verified) return answer;
    if (answer.score > best.score) best = answer;
  }
  return best;
}

LoopVerification verifyStep(const LoopTask& task, const SlamParams& params) {
  SlamParams of_step = params;
  LoopParams& p = of_step.loop;
  p.far_min_score = p.far_min_inlier_ratio = params.step_check.min_score;
  p.min_overlap = params.step_check.min_overlap;
  return verifyLoop(task, of_step);
}

}  // namespace ngram_slam

#include "ngram_slam/slam/loop_verifier.hpp"

#include <algorithm>

#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "hyselam_scan_matching/icp.hpp"

namespace ngram_slam {

namespace {

using namespace hyselam_scan_matching;  // NOLINT: their words are this file's

constexpr std::size_t kNearPoints = 80, kFarPoints = 250, kRefinedPoints = 1000;
constexpr double kSpaceSide = 100.0;  // [m]

/// Every n-th point, so that about `most` remain.
SurfacePoints thinned(const SurfacePoints& points, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / most);
  SurfacePoints few;
  for (std::size_t i = 0; i < points.size(); i += step) few.push_back(points[i]);
  return few;
}

SurfaceMap mapOf(const LoopTask::Stretch& stretch, double cell) {
  SurfaceMap map(cell);
  for (const LoopTask::Seen& s : stretch) map.insert(s.pose, *s.points);
  map.finish();
  return map;
}

SeenSpace spaceOf(const LoopTask::Stretch& stretch, double cell) {
  SeenSpace space(kSpaceSide, cell);
  for (const LoopTask::Seen& s : stretch) space.insert(s.pose, *s.points, s.laser);
  return space;
}

}  // namespace

LoopAnswer verifyLoop(const LoopTask& task, const SlamParams& params) {
  LoopAnswer answer;
  SlamLoop& loop = answer.loop;
  loop.older = task.older;
  loop.newer = task.newer;
  loop.source = task.source;
  loop.far = task.far;
  const LoopParams& p = params.loop;
  const SurfaceMap old_map = mapOf(task.old_stretch, params.local_cell);
  SurfacePoints points;
  std::size_t scans = 1;
  if (task.far) {
    points = mapOf(task.new_stretch, 0.5 * p.far_resolution).points();
    scans = task.new_stretch.size();
  } else if (!task.new_stretch.empty()) {
    points = transformed(task.new_stretch[0].pose, *task.new_stretch[0].points);
  }
  if (points.empty() || old_map.empty()) return answer;

  CorrelativeMatcherParams s;
  s.linear_window = task.window;
  s.angular_window = task.turn;
  s.min_score = task.far ? p.far_score : p.near_score;
  s.resolution = task.far ? p.far_resolution : 0.06;
  s.max_distance = task.far ? 3.0 * p.far_resolution : 0.2;
  const CorrelativeMatcher grid(old_map, s);
  const SurfacePoints few = thinned(points, task.far ? kFarPoints : kNearPoints);
  const auto found = grid.match(few, task.guess);
  if (!found) return answer;
  answer.score = found->score;
  if (task.far && p.rival_share < 1.0) {
    const auto rival =
        grid.secondBest(few, task.guess, found->pose, p.rival_apart, p.rival_share * found->score);
    if (rival) {
      answer.rival = rival->score;
      return answer;
    }
  }
  const SurfacePoints many = task.far ? thinned(points, kRefinedPoints) : points;
  const IcpResult r = alignIcp(many, old_map, found->pose, Eigen::Matrix3d::Zero(), params.refine);
  loop.measured = r.pose;
  loop.matched = r.matched;
  // A stretch of many scans is believed no more than one of them: its inner errors are one's own.
  const double share =
      task.far
          ? std::min(1.0, static_cast<double>(points.size()) /
                              static_cast<double>(many.size() * std::max<std::size_t>(1, scans)))
          : 1.0;
  loop.information = params.scan_information * share * r.information + Eigen::Matrix3d::Identity();
  loop.information = (0.5 * (loop.information + loop.information.transpose())).eval();
  const double least_matched = task.far ? p.far_matched : p.near_matched;
  if (r.matched < least_matched) return answer;
  // Either may not stand where the other saw that nothing is.
  answer.new_in_old = spaceOf(task.old_stretch, p.far_resolution).overlap(r.pose, points);
  answer.old_in_new =
      spaceOf(task.new_stretch, p.far_resolution).overlap(r.pose.inverse(), old_map.points());
  const auto fits = [&](const Overlap& o, double least_known) {
    return o.known >= least_known && o.fit >= (task.far ? p.far_fit : p.near_fit);
  };
  answer.verified = fits(answer.new_in_old, p.least_known) && fits(answer.old_in_new, 0.0);
  return answer;
}

}  // namespace ngram_slam

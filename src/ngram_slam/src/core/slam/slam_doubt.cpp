// Where the engine does not believe odometry: wheels that stand in it while the robot moves, slip,
// gaps without scans.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::LaserScan;
using hyselam::Pose2;
using hyselam_scan_matching::CorrelativeMatcher;
using hyselam_scan_matching::IcpResult;
using hyselam_scan_matching::SurfacePoints;

namespace {

constexpr double kSearchResolution = 0.1;  // [m]
constexpr double kUnseenPenalty = 2.0;     // negative logarithm of a probability

/// Half the square of an error in its standard deviations.
double costOf(const Pose2& error, const Eigen::Matrix3d& information) {
  const Eigen::Vector3d e(error.x, error.y, error.theta);
  return 0.5 * e.dot(information * e);
}

}  // namespace

/// Whether a scan at which odometry tells hardly any motion needs no matching. If it does, notes
/// why.
bool SlamEngine::mayStand(const LaserScan& scan, Motion* motion) const {
  if (!params_.refine_odometry) return true;
  const OdometryDoubtParams& p = params_.odometry_doubt;
  motion->unseen = scansDiffer(doubt_.matched, scan, p);
  return !motion->unseen && !(p.scan_interval > 0.0 && motion->seconds >= p.scan_interval);
}

void SlamEngine::noteMatched(const LaserScan& scan) {
  doubt_.matched = scan;
  doubt_.unfit_since.reset();
}

/// Asks the scan without odometry where it contradicts odometry or does not fit: in `best`, the
/// motion that is more probable.
void SlamEngine::doubtOdometry(const SurfacePoints& points, const Motion& motion, IcpResult* best,
                               SlamUpdate* update) {
  const OdometryDoubtParams& p = params_.odometry_doubt;
  if (p.failure_probability <= 0.0 || local_map_.empty() ||
      points.size() <= static_cast<std::size_t>(params_.relocalization.min_points)) {
    return;
  }
  if (motion.jump) {
    searchAfterJump(points, motion, best);
    return;
  }
  const double tension = costOf(between(pose_, best->pose), motion.information);
  if (!motion.unseen && best->matched >= params_.min_inlier_ratio &&
      tension < 0.5 * p.max_deviations * p.max_deviations) {
    return;
  }
  const Eigen::Matrix3d free = p.freeMotionInformation(motion.seconds);
  IcpResult other = alignIcpFrom(best->pose, points, local_map_, pose_, free, params_.refine);
  if (other.matched < params_.min_inlier_ratio) {
    if (const auto found = searchWide(points, motion)) {
      ++doubt_.road.wide_searches;
      if (found->matched > other.matched) other = *found;
    }
  }
  // What does not fit tells nothing about the odometry.
  if (other.matched < params_.weak_match_factor * params_.min_inlier_ratio) return;
  const auto cost = [&](const IcpResult& r, const Eigen::Matrix3d& information) {
    return params_.scan_information_scale * r.cost + costOf(between(pose_, r.pose), information);
  };
  // While odometry stands and the scan is another one, odometry fails more often: but people who
  // walk past change scans, too.
  // Otherwise the wider distribution has to be worth its width.
  const double penalty =
      motion.unseen
          ? kUnseenPenalty
          : std::max(0.0, 0.5 * std::log(motion.information.determinant() / free.determinant())) -
                std::log(p.failure_probability);
  if (cost(other, free) + penalty >= cost(*best, motion.information)) return;
  const Pose2 driven = between(matched_pose_, other.pose);
  if (motion.unseen && std::hypot(driven.x, driven.y) < params_.scan_step &&
      std::abs(driven.theta) < params_.scan_turn) {
    return;  // as odometry says
  }
  path_length_ +=
      std::max(0.0, std::hypot(driven.x, driven.y) - std::hypot(motion.pose.x, motion.pose.y));
  if (motion.unseen) {
    ++doubt_.road.scans_moved_unseen;
    doubt_.road.path_unseen += std::hypot(driven.x, driven.y);
    doubt_.road.turn_unseen += std::abs(driven.theta);
  }
  ++doubt_.road.odometry_overruled;
  doubt_.since_keyframe = update->odometry_overruled = true;
  *best = other;
}

/// A robot whose odometry jumped is taken to stand where its scan does not say otherwise.
void SlamEngine::searchAfterJump(const SurfacePoints& points, const Motion& motion,
                                 IcpResult* best) {
  if (best->matched >= params_.min_inlier_ratio) return;
  const auto found = searchWide(points, motion);
  if (!found) return;
  ++doubt_.road.wide_searches;
  if (found->matched > best->matched + params_.relocalization.min_gain) *best = *found;
}

/// Searches all that the robot may have reached since the last match, if that is more than is
/// searched anyway. Nothing if nothing fits, or if the scan fits elsewhere nearly as well.
std::optional<IcpResult> SlamEngine::searchWide(const SurfacePoints& points,
                                                const Motion& motion) const {
  const OdometryDoubtParams& p = params_.odometry_doubt;
  const RelocalizationParams& narrow = params_.relocalization;
  hyselam_scan_matching::CorrelativeMatcherParams search;
  search.resolution = kSearchResolution;
  search.max_distance = 2.0 * kSearchResolution;
  search.linear_window = std::min(p.max_window, p.max_speed * motion.seconds);
  search.angular_window = std::min(hyselam::kPi, p.max_turn_rate * motion.seconds);
  search.min_score = narrow.min_score;
  if (search.linear_window <= narrow.window && search.angular_window <= narrow.angle) {
    return std::nullopt;
  }
  const CorrelativeMatcher matcher(local_map_, search);
  const auto found = matcher.match(points, pose_);
  if (!found || matcher.secondBest(points, pose_, found->pose, params_.loop.ambiguity_distance,
                                   params_.loop.max_ambiguity_ratio * found->score)) {
    return std::nullopt;
  }
  return alignIcpFrom(found->pose, points, local_map_, pose_,
                      p.freeMotionInformation(motion.seconds), params_.refine);
}

/// Whether nothing tells how the robot moved: odometry is known to fail and the scan does not fit.
bool SlamEngine::tellsNothing(const Motion& motion, const SlamUpdate& update) const {
  return update.weak_match && params_.odometry_doubt.failure_probability > 0.0 &&
         (motion.jump || motion.unseen);
}

/// Whether somebody may only stand in front of the laser.
bool SlamEngine::awaitsMore(const Motion& motion) {
  if (!doubt_.unfit_since) doubt_.unfit_since = last_stamp_;
  return !motion.jump && last_stamp_ - *doubt_.unfit_since < params_.odometry_doubt.patience;
}

/// Without loops that scans verify a run would not find back.
bool SlamEngine::splitsRuns() const {
  return params_.loops != LoopClosureMode::kNone && params_.loops != LoopClosureMode::kThesis;
}

/// Begins another run with the scan, supposed to be where the robot is by odometry: a map that is
/// bent here would be worse than two.
void SlamEngine::splitRun(const LaserScan& scan, const Pose2& by_odometry) {
  const Pose2 odometry = odometry_;
  startRun(by_odometry);
  beginRun(scan, odometry);
  ++doubt_.road.runs_split;
}

}  // namespace ngram_slam

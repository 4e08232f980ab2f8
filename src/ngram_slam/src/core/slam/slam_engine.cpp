// Scans of the engine: odometry, local map, keyframes. Its other parts: where odometry is doubted,
// slam_doubt.cpp; steps that are asked again, slam_steps.cpp; the start of a run, slam_runs.cpp;
// where it lies in earlier maps, slam_run_places.cpp; loops, slam_loops.cpp; work on another
// thread, slam_jobs.cpp.
#include "ngram_slam/slam/slam_engine.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "ngram_slam/slam/input_checks.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;
using hyselam_scan_matching::CorrelativeMatcher;
using hyselam_scan_matching::IcpResult;
using hyselam_scan_matching::SurfaceMap;
using hyselam_scan_matching::SurfacePoints;

namespace {

constexpr double kInlierCells = 3.0;  // points score up to so many cells from a surface

void checkScan(const hyselam::LaserScan& scan) {
  if (!std::isfinite(scan.stamp)) throw hyselam::InputError("scan", "", "its time is not finite");
  if (const char* reason = scanError(scan)) {
    throw hyselam::InputError("scan", "scan at " + std::to_string(scan.stamp) + " s", reason);
  }
}

void checkOdometry(const Pose2& odometry, double stamp) {
  if (const char* reason = poseError(odometry)) {
    throw hyselam::InputError("odometry", "scan at " + std::to_string(stamp) + " s", reason);
  }
}

SlamParams checked(const SlamParams& p) {
  p.validate();
  return p;
}

double positionStddev(const Eigen::Matrix3d& odometry_information) {
  return 1.0 / std::sqrt(odometry_information(0, 0));
}

double headingStddev(const Eigen::Matrix3d& odometry_information) {
  return 1.0 / std::sqrt(odometry_information(2, 2));
}

/// Whether a motion is shorter than `step` [m] and turns by less than `turn` [rad].
bool isWithin(const Pose2& motion, double step, double turn) {
  return std::hypot(motion.x, motion.y) < step && std::abs(motion.theta) < turn;
}

}  // namespace

SlamEngine::SlamEngine(const SlamParams& params) : SlamEngine(params, SlamState{}) {}

SlamEngine::SlamEngine(const SlamParams& params, SlamState state)
    : params_(checked(params)),
      state_((state.validate(), std::move(state))),
      odometry_noise_(params.odometry, params.odometry_learning),
      words_(params.observations, params.words, std::move(state_.corpus)),
      local_map_(params.local_map_resolution) {
  state_.corpus = {};
  if (usesSignatures()) {
    signatures_ = std::make_shared<SignaturePlaces>(
        params.signatures,
        [p = params.loop](double path_length) { return p.signatureReach(path_length); });
  }
  rebuildPathLengths();
  if (state_.keyframes.empty()) return;
  connections_ = RunConnections(state_.keyframes, state_.loops);
  queueSavedKeyframes();
  const SlamKeyframe& last = state_.keyframes.back();
  session_ = last.run + 1;
  path_length_ = run_.begin = last.path_length;
  far_search_path_length_ = path_length_;
  pose_ = matched_pose_ = last.pose;
  odometry_ = matched_odometry_ = last.odometry;
  if (!state_.scans.empty() && state_.scans.back().keyframe == lastKeyframe()) {
    pose_ = last.pose * state_.scans.back().base_in_keyframe;
  }
  optimized_keyframes_ = static_cast<int>(state_.keyframes.size());
}

SlamState SlamEngine::state() const {
  SlamState s = state_;
  s.corpus = words_.recognizer().corpus();
  return s;
}

Pose2 SlamEngine::odomInMap() const {
  return pose_ * odometry_.inverse();
}

SlamUpdate SlamEngine::add(const hyselam::LaserScan& scan, const Pose2& odometry) {
  checkScan(scan);
  checkOdometry(odometry, scan.stamp);
  if (run_open_ && scan.stamp <= last_stamp_) {
    throw hyselam::InputError(
        "scan", std::to_string(scan.stamp) + " s",
        "does not come after the last one, " + std::to_string(last_stamp_) + " s");
  }
  ++state_.counters.scans;
  const double since_last = run_open_ ? scan.stamp - last_stamp_ : 0.0;
  last_stamp_ = scan.stamp;
  SlamUpdate update;
  if (!run_open_) {
    beginRun(scan, odometry);
    update.keyframe = true;
    update.base_in_map = pose_;
    return update;
  }
  Motion motion = advanceOdometry(odometry);
  motion.seconds = scan.stamp - doubt_.matched.stamp;
  const Pose2 by_odometry = pose_;
  update.odometry_jump = motion.jump;
  if (since_last >= params_.odometry_doubt.gap) ++doubt_.road.gaps;
  if (isNearLastMatch(motion) && mayStand(scan, &motion)) {
    recordScanPose(scan.stamp);
    update.base_in_map = pose_;
    return update;
  }
  const Points points = std::make_shared<const SurfacePoints>(surfacePoints(scan, params_.surface));
  const Eigen::Matrix3d scan_information = matchScan(*points, motion, &update);
  if (update.awaited) {
    recordScanPose(scan.stamp);
    update.base_in_map = pose_;
    return update;
  }
  noteMatched(scan);
  if (update.lost && splitsRuns()) {
    splitRun(scan, by_odometry);
    update.keyframe = true;
    update.base_in_map = pose_;
    return update;
  }
  if (needsKeyframe(motion)) {
    if (!update.weak_match && !doubt_.since_keyframe) learnOdometryNoise(motion, scan_information);
    const PoseEdge edge = odometryEdge(motion, scan_information);
    noteStep(motion);
    addKeyframe(scan, points, &edge);
    searchLoopClosures();
    update.keyframe = true;
  } else {
    recordScanPose(scan.stamp);
  }
  if (usesWords()) update.word_matches = addWords(scan);
  update.base_in_map = pose_;
  return update;
}

/// Moves the pose by odometry. After a jump the robot is taken to have stood.
SlamEngine::Motion SlamEngine::advanceOdometry(const Pose2& odometry) {
  Motion motion;
  motion.jump = hyselam::distance(odometry_, odometry) > params_.max_odometry_step;
  if (motion.jump) {
    ++state_.counters.odometry_jumps;
    motion.pose = between(matched_odometry_, odometry_);
    motion.information = params_.jump_information * Eigen::Matrix3d::Identity();
  } else {
    motion.pose = between(matched_odometry_, odometry);
    motion.information = odometry_noise_.noise().information(motion.pose);
    const Pose2 step = between(odometry_, odometry);
    path_length_ += std::hypot(step.x, step.y);
  }
  odometry_ = odometry;
  pose_ = matched_pose_ * motion.pose;
  return motion;
}

bool SlamEngine::isNearLastMatch(const Motion& motion) const {
  return !motion.jump && isWithin(motion.pose, params_.scan_step, params_.scan_turn);
}

/// Refines the pose by the scan. Returns what the scan says about it: zero if it is not asked.
Eigen::Matrix3d SlamEngine::matchScan(const SurfacePoints& points, const Motion& motion,
                                      SlamUpdate* update) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  if (params_.refine_odometry) {
    const IcpResult refined = matchLocalMap(points, motion, update);
    if (update->awaited) return information;
    information = refined.information;
    pose_ = refined.pose;
  }
  smooth_pose_ = smooth_pose_ * between(matched_pose_, pose_);
  matched_pose_ = pose_;
  matched_odometry_ = odometry_;
  return information;
}

/// Matches with the local map; a scan that does not fit, or whose points odometry may have put
/// beyond the reach of the refinement, is searched around the pose.
IcpResult SlamEngine::matchLocalMap(const SurfacePoints& points, const Motion& motion,
                                    SlamUpdate* update) {
  ++state_.counters.matched;
  const RelocalizationParams& p = params_.relocalization;
  IcpResult best = alignIcp(points, local_map_, pose_, motion.information, params_.refine);
  if (points.size() > static_cast<std::size_t>(p.min_points) && !local_map_.empty()) {
    const bool beyond = isBeyondRefinement(points, motion);
    doubt_.searched = doubt_.searched || beyond;
    const auto better = beyond ? searchByLikelihood(points, motion, best)
                        : best.matched < params_.min_inlier_ratio
                            ? searchByInliers(points, motion, best)
                            : std::nullopt;
    if (better) {
      best = *better;
      ++state_.counters.relocalized;
    }
  }
  doubtOdometry(points, motion, &best, update);
  if (best.matched < params_.weak_match_factor * params_.min_inlier_ratio) {
    update->weak_match = true;
    ++state_.counters.weak_matches;
  }
  if (tellsNothing(motion, *update)) {
    update->awaited = awaitsMore(motion);
    update->lost = !update->awaited;
    if (update->lost) ++doubt_.road.lost;
  }
  return best;
}

/// Whether errors of the odometry put points of the scan farther from their surfaces than the
/// refinement looks for them. It may then end beside the true pose with most points near some
/// surface: a share of inliers does not tell.
bool SlamEngine::isBeyondRefinement(const SurfacePoints& points, const Motion& motion) const {
  if (motion.jump) return false;
  double squares = 0.0;
  for (const auto& q : points) squares += q.x * q.x + q.y * q.y;
  const double lever = std::sqrt(squares / static_cast<double>(points.size()));
  return params_.relocalization.max_deviations *
             std::hypot(positionStddev(motion.information),
                        lever * headingStddev(motion.information)) >
         params_.refine.initial_distance;
}

/// A search of the window that the odometry's noise leaves, wider for a scan that does not fit.
/// What it finds is taken if it is more probable than `best`, by the scan and by odometry.
std::optional<IcpResult> SlamEngine::searchByLikelihood(const SurfacePoints& points,
                                                        const Motion& motion,
                                                        const IcpResult& best) const {
  const RelocalizationParams& p = params_.relocalization;
  const Eigen::Matrix3d& odometry = motion.information;
  const bool lost = best.matched < params_.min_inlier_ratio;
  hyselam_scan_matching::CorrelativeMatcherParams search;
  search.resolution = p.uncertain_resolution;
  search.max_distance = kInlierCells * p.uncertain_resolution;
  search.linear_window =
      std::max(lost ? p.window : 0.0, p.window_deviations * positionStddev(odometry));
  search.angular_window = std::min(
      hyselam::kPi, std::max(lost ? p.angle : 0.0, p.window_deviations * headingStddev(odometry)));
  search.min_score = 0.0;  // the likelihood decides
  const auto found = CorrelativeMatcher(local_map_, search).match(points, pose_);
  if (!found) return std::nullopt;
  const IcpResult other =
      alignIcpFrom(found->pose, points, local_map_, pose_, odometry, params_.refine);
  const auto cost = [&](const IcpResult& r) {
    const Pose2 error = between(pose_, r.pose);
    const Eigen::Vector3d e(error.x, error.y, error.theta);
    return params_.scan_information_scale * r.cost + 0.5 * e.dot(odometry * e);
  };
  return cost(other) < cost(best) ? std::make_optional(other) : std::nullopt;
}

/// A search of a fixed window. What it finds is taken if clearly more of the points fit than in
/// `best`.
std::optional<IcpResult> SlamEngine::searchByInliers(const SurfacePoints& points,
                                                     const Motion& motion,
                                                     const IcpResult& best) const {
  const RelocalizationParams& p = params_.relocalization;
  hyselam_scan_matching::CorrelativeMatcherParams search;
  search.linear_window = p.window;
  search.angular_window = p.angle;
  search.min_score = p.min_score;
  const auto found = CorrelativeMatcher(local_map_, search).match(points, pose_);
  if (!found) return std::nullopt;
  const IcpResult other =
      alignIcp(points, local_map_, found->pose, p.odometry_information_scale * motion.information,
               params_.refine);
  return other.matched > best.matched + p.min_gain ? std::make_optional(other) : std::nullopt;
}

bool SlamEngine::needsKeyframe(const Motion& motion) const {
  return motion.jump || !isWithin(between(state_.keyframes.back().pose, pose_),
                                  params_.keyframe_step, params_.keyframe_turn);
}

/// What odometry said since the last keyframe, against what the scans did.
void SlamEngine::learnOdometryNoise(const Motion& motion, const Eigen::Matrix3d& scan_information) {
  if (motion.jump || !params_.refine_odometry) return;
  const SlamKeyframe& last = state_.keyframes.back();
  const Pose2 told = between(last.odometry, odometry_);
  odometry_noise_.add(told, between(told, between(last.pose, pose_)),
                      params_.scan_information_scale * scan_information);
}

/// From the last keyframe to the pose.
PoseEdge SlamEngine::odometryEdge(const Motion& motion,
                                  const Eigen::Matrix3d& scan_information) const {
  PoseEdge edge;
  edge.from = lastKeyframe();
  edge.to = edge.from + 1;
  edge.measured = between(state_.keyframes.back().pose, pose_);
  const Eigen::Matrix3d odometry =
      motion.jump ? motion.information
      : doubt_.since_keyframe
          ? params_.odometry_doubt.freeMotionInformation(last_stamp_ - doubt_.stamp_of_keyframe)
          : odometry_noise_.noise().information(edge.measured);
  edge.information = params_.refine_odometry
                         ? Eigen::Matrix3d(params_.scan_information_scale * scan_information +
                                           params_.odometry_information_scale * odometry)
                         : odometry;
  edge.information = (0.5 * (edge.information + edge.information.transpose())).eval();
  return edge;
}

/// Notes a scan that is no keyframe, relative to the last one.
void SlamEngine::recordScanPose(double stamp) {
  state_.scans.push_back({stamp, lastKeyframe(), between(state_.keyframes.back().pose, pose_)});
}

/// Appends a keyframe at the pose; without `edge` it is the first of a run.
void SlamEngine::addKeyframe(const hyselam::LaserScan& scan, Points points, const PoseEdge* edge) {
  SlamKeyframe k;
  k.stamp = scan.stamp;
  k.odometry = odometry_;
  k.pose = pose_;
  k.path_length = path_length_;
  k.run = state_.keyframes.empty() ? 0 : state_.keyframes.back().run;
  if (edge == nullptr && !state_.keyframes.empty()) ++k.run;
  k.scan = std::make_shared<const hyselam::LaserScan>(scan);
  k.points = std::move(points);
  state_.keyframes.push_back(std::move(k));
  state_.scans.push_back({scan.stamp, lastKeyframe(), {}});
  doubt_.since_keyframe = doubt_.searched = false;
  doubt_.stamp_of_keyframe = scan.stamp;
  if (edge == nullptr) doubt_.steps.clear();
  if (edge != nullptr) {
    state_.odometry.push_back(*edge);
    path_lengths_.addEdge(edge->from, edge->to, std::hypot(edge->measured.x, edge->measured.y));
  }
  queueKeyframe(lastKeyframe(), edge == nullptr ? nullptr : &edge->measured);
  rebuildLocalMap();
}

/// Observes the density at the pose, and adds the matches of words that it completes: their number.
int SlamEngine::addWords(const hyselam::LaserScan& scan) {
  const std::size_t before = state_.matches.size();
  addWordMatches(words_.add(scan, smooth_pose_));
  // All matches are found again when words are quantized again: there may be fewer.
  return static_cast<int>(state_.matches.size() - std::min(before, state_.matches.size()));
}

void SlamEngine::rebuildLocalMap() {
  local_map_ = SurfaceMap(params_.local_map_resolution);
  const auto n = static_cast<int>(state_.keyframes.size());
  const int first = std::max(first_of_run_, n - params_.local_map_keyframes);
  const Pose2& here = state_.keyframes.back().pose;
  // A run that has only begun is matched with what earlier ones saw there.
  if (first_of_run_ > 0 && n - first < params_.local_map_keyframes) {
    for (int k = 0; k < first_of_run_; ++k) {
      if (connections_.connected(keyframe(k).run, currentRun()) &&
          distance(keyframe(k).pose, here) < params_.run_start.local_map_radius) {
        local_map_.insert(keyframe(k).pose, *keyframe(k).points);
      }
    }
  }
  for (int k = first; k < n; ++k) local_map_.insert(keyframe(k).pose, *keyframe(k).points);
  local_map_.finish();
}

hyselam_pose_graph::PoseGraph SlamEngine::graph() const {
  return runGraph(state_, 0).graph;
}

std::vector<hyselam::StampedPose2> SlamEngine::trajectory() const {
  std::vector<hyselam::StampedPose2> out;
  out.reserve(state_.scans.size());
  for (const PlacedScan& s : state_.scans) {
    out.push_back({s.stamp, keyframe(s.keyframe).pose * s.base_in_keyframe});
  }
  return out;
}

}  // namespace ngram_slam

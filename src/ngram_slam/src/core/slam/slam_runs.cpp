// Runs of the engine: where one begins, and what is matched there.
#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;
using hyselam_scan_matching::CorrelativeMatcher;
using hyselam_scan_matching::IcpResult;
using hyselam_scan_matching::SurfaceMap;
using hyselam_scan_matching::SurfacePoints;

namespace {

constexpr double kOdometryWindow = 0.1;  // [m], [rad] searched where odometry gives the start
constexpr double kOdometryDrift = 0.1;   // [m/m], [rad/m]

}  // namespace

void SlamEngine::startRun(const Pose2& base_in_map, double window, double angle, RunTrust trust) {
  if (!base_in_map.isFinite()) throw hyselam::ParameterError("base_in_map", "not finite", "finite");
  if (!(window > 0.0 && window <= kMaxStartWindow)) {
    throw hyselam::ParameterError("window", window, "above 0, at most 50 m");
  }
  if (!(angle >= 0.0 && angle <= hyselam::kPi)) {
    throw hyselam::ParameterError("angle", angle, "from 0 to pi");
  }
  endRun();
  start_ = RunStart{base_in_map, window, angle, trust, false};
}

void SlamEngine::startRunByOdometry(const Pose2& base_in_odom) {
  const SlamKeyframe& last = state_.keyframes.back();
  const Pose2 driven = between(last.odometry, base_in_odom);
  const double window = kOdometryWindow + kOdometryDrift * std::hypot(driven.x, driven.y);
  startRun(last.pose * driven, std::min(window, kMaxStartWindow), std::min(window, hyselam::kPi),
           RunTrust::kKnown);
}

void SlamEngine::startRunAnywhere() {
  endRun();
  start_ = RunStart{pose_, kMaxStartWindow, hyselam::kPi, RunTrust::kSupposed, true};
}

void SlamEngine::endRun() {
  if (!run_open_) return;
  if (usesWords()) addWordMatches(words_.finish());
  run_to_end_ = usesSignatures();
  run_open_ = false;
  run_.other_maps.reset();  // a question that still waits has its own hold of them
}

void SlamEngine::beginRun(const hyselam::LaserScan& scan, const Pose2& odometry) {
  Points points = std::make_shared<const SurfacePoints>(surfacePoints(scan, params_.surface));
  odometry_ = matched_odometry_ = odometry;
  noteMatched(scan);
  smooth_pose_ = odometry;
  first_of_run_ = static_cast<int>(state_.keyframes.size());
  run_ = Run{};
  run_.begin = run_.searched = run_.searched_map = run_.drawn = path_length_;
  place_question_.reset();
  doubts_.clear();
  const RunStart start = start_.value_or(
      RunStart{pose_, kDefaultStartWindow, kDefaultStartAngle, RunTrust::kSupposed, false});
  if (first_of_run_ == 0) {
    pose_ = start_ && !start_->anywhere ? start_->pose : odometry;
    addKeyframe(scan, std::move(points), nullptr);
  } else if (start.trust == RunTrust::kKnown || params_.loops == LoopClosureMode::kNone ||
             params_.loops == LoopClosureMode::kThesis) {  // no loops would tell
    beginRunInKnownMap(scan, std::move(points), start);
  } else {
    beginRunSomewhere(scan, std::move(points), start);
  }
  matched_pose_ = pose_;
  start_.reset();
  run_open_ = true;
  if (usesWords()) addWords(scan);
}

/// A map of its own, until loops tell where it lies. Its first scan is laid on what is supposed to
/// be around it: a better guess, which counts for nothing else.
void SlamEngine::beginRunSomewhere(const hyselam::LaserScan& scan, Points points,
                                   const RunStart& start) {
  pose_ = start.pose;
  run_.anywhere = start.anywhere;
  run_.supposed_in = largestMapBut(currentRun() + 1);
  if (!start.anywhere) {
    RunStart near = start;
    near.window = std::min(start.window, kDefaultStartWindow);
    near.angle = std::min(start.angle, kDefaultStartAngle);
    if (const auto found = matchAround(near, *points)) pose_ = found->pose;
  }
  addKeyframe(scan, std::move(points), nullptr);
}

/// Searches the first scan of a run around where it starts, and ties it to the nearest keyframe.
void SlamEngine::beginRunInKnownMap(const hyselam::LaserScan& scan, Points points,
                                    const RunStart& start) {
  const RunStartParams& p = params_.run_start;
  pose_ = start.pose;
  const auto nearest =
      std::min_element(state_.keyframes.begin(), state_.keyframes.end(),
                       [&](const SlamKeyframe& a, const SlamKeyframe& b) {
                         return distance(a.pose, start.pose) < distance(b.pose, start.pose);
                       });
  SlamLoop tie;
  tie.older = static_cast<int>(nearest - state_.keyframes.begin());
  tie.newer = first_of_run_;
  tie.information =
      Eigen::Vector3d(p.position_information, p.position_information, p.heading_information)
          .asDiagonal();
  if (const auto found = matchAround(start, *points)) {
    pose_ = found->pose;
    tie.inlier_ratio = found->matched;
    tie.information += params_.scan_information_scale * found->information;
    tie.information = (0.5 * (tie.information + tie.information.transpose())).eval();
  }
  tie.measured = between(nearest->pose, pose_);
  addKeyframe(scan, std::move(points), nullptr);
  addLoopEdge(tie);
  run_.tied = path_length_;
  run_.known = true;
}

/// Searches a scan around a start; nothing if it does not fit there.
std::optional<IcpResult> SlamEngine::matchAround(const RunStart& start,
                                                 const SurfacePoints& points) const {
  const SurfaceMap map = mapAround(start);
  hyselam_scan_matching::CorrelativeMatcherParams search;
  search.linear_window = start.window;
  search.angular_window = start.angle;
  search.min_score = params_.run_start.min_score;
  const auto found = CorrelativeMatcher(map, search).match(points, start.pose);
  if (!found) return std::nullopt;
  const IcpResult refined =
      alignIcp(points, map, found->pose, Eigen::Matrix3d::Zero(), params_.refine);
  return refined.matched >= params_.min_inlier_ratio ? std::make_optional(refined) : std::nullopt;
}

/// What earlier runs saw around the start.
SurfaceMap SlamEngine::mapAround(const RunStart& start) const {
  SurfaceMap map(params_.local_map_resolution);
  for (int k = 0; k < first_of_run_; ++k) {
    if (distance(keyframe(k).pose, start.pose) < params_.run_start.map_radius + start.window) {
      map.insert(keyframe(k).pose, *keyframe(k).points);
    }
  }
  map.finish();
  return map;
}

}  // namespace ngram_slam

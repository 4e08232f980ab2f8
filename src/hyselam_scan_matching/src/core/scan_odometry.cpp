#include "hyselam_scan_matching/scan_odometry.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_scan_matching/correlative_matcher.hpp"

namespace hyselam_scan_matching {

namespace {

using hyselam::Pose2;
using hyselam::Range;

constexpr std::size_t kMinSearchPoints = 30;     // a search with fewer finds anything
constexpr double kSearchedOdometryScale = 0.05;  // what odometry counts after a search

/// Inverse covariance of a motion that wheels tell: deviations of 1 cm and 0.01 rad, 10 % of the
/// way, 10 % of the turn, and what each adds to the other.
Eigen::Matrix3d odometryInformation(const Pose2& motion) {
  const double length = std::hypot(motion.x, motion.y), angle = std::abs(motion.theta);
  const double position = 0.01 + 0.1 * length + 0.05 * angle;
  const double heading = 0.01 + 0.1 * angle + 0.05 * length;
  const double p = 1.0 / (position * position);
  return Eigen::Vector3d(p, p, 1.0 / (heading * heading)).asDiagonal();
}

bool isWithin(const Pose2& motion, double step, double turn) {
  return std::hypot(motion.x, motion.y) < step && std::abs(motion.theta) < turn;
}

}  // namespace

void ScanOdometryParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("surface/", surface);
  visit.group("refine/", refine);
  visit("scan_step", scan_step, Range::atLeast(0.0), "m",
        "a scan this near to the last match is not matched");
  visit("scan_turn", scan_turn, Range::atLeast(0.0), "rad", "nor within this turn");
  visit("max_step", max_step, Range::above(0.0), "m",
        "a larger step between two scans is a jump of the odometry");
  visit("keyframe_step", keyframe_step, Range::above(0.0), "m",
        "distance of the scans that make the local map");
  visit("keyframe_turn", keyframe_turn, Range::above(0.0), "rad", "or turn between them");
  visit("local_map_keyframes", local_map_keyframes, Range::atLeast(1), "",
        "scans that make the local map");
  visit("local_map_resolution", local_map_resolution, Range::above(0.0), "m", "of the local map");
  visit("min_inlier_ratio", min_inlier_ratio, Range::between(0.0, 1.0), "",
        "part of a scan on known surfaces, below which its pose is searched");
  visit("search_window", search_window, Range::above(0.0), "m", "positions searched, each way");
  visit("search_angle", search_angle, Range::between(0.0, hyselam::kPi), "rad",
        "headings searched, each way");
  visit("search_min_score", search_min_score, Range::between(0.0, 1.0), "", "of the search");
  visit("search_min_gain", search_min_gain, Range::between(0.0, 1.0), "",
        "gain in inlier ratio for what the search found to count");
  visit("weak_inlier_ratio", weak_inlier_ratio, Range::between(0.0, 1.0), "",
        "part of a scan on known surfaces, below which odometry is taken as it is");
  visit("max_weak_matches", max_weak_matches, Range::atLeast(1), "",
        "weak matches in a row that break the track");
}

void ScanOdometryParams::validate() const {
  hyselam::checkParameters(*this);
  refine.validate();
}

ScanOdometry::ScanOdometry(const ScanOdometryParams& params)
    : params_((params.validate(), params)), local_map_(params.local_map_resolution) {}

void ScanOdometry::reset() {
  started_ = false;
}

void ScanOdometry::begin(const SurfacePoints& points) {
  keyframes_ = 0;
  local_map_ = SurfaceMap(params_.local_map_resolution);
  weak_ = 0;
  searched_in_vain_.reset();
  matched_pose_ = pose_;
  matched_odometry_ = odometry_;
  addKeyframe(points);
}

void ScanOdometry::addKeyframe(const SurfacePoints& points) {
  keyframe_pose_ = pose_;
  local_map_.insert(pose_, points);
  if (++keyframes_ > params_.local_map_keyframes) {
    local_map_.dropOldest();
    --keyframes_;
  }
  local_map_.finish();
}

ScanOdometry::Step ScanOdometry::add(const hyselam::LaserScan& scan, const Pose2& odometry) {
  Step step;
  if (!started_) {
    started_ = true;
    pose_ = odometry_ = odometry;
    begin(surfacePoints(scan, params_.surface));
    step.pose = pose_;
    return step;
  }
  step.broken = hyselam::distance(odometry_, odometry) > params_.max_step;
  if (step.broken) {  // the robot is taken to have stood
    odometry_ = odometry;
    begin(surfacePoints(scan, params_.surface));
    step.pose = pose_;
    return step;
  }
  odometry_ = odometry;
  const Pose2 motion = between(matched_odometry_, odometry);
  pose_ = matched_pose_ * motion;
  step.pose = pose_;
  if (isWithin(motion, params_.scan_step, params_.scan_turn)) return step;

  const SurfacePoints points = surfacePoints(scan, params_.surface);
  if (points.empty()) return step;  // nothing to see: by the wheels until there is
  const IcpResult match = this->match(points, motion);
  step.matched = true;
  step.inlier_ratio = match.matched;
  const bool weak = match.matched < params_.weak_inlier_ratio;
  weak_ = weak ? weak_ + 1 : 0;
  if (!weak) step.pose = pose_ = match.pose;
  matched_pose_ = pose_;
  matched_odometry_ = odometry;
  if (weak_ >= params_.max_weak_matches) {
    step.broken = true;
    begin(points);
  } else if (!isWithin(between(keyframe_pose_, pose_), params_.keyframe_step,
                       params_.keyframe_turn)) {
    addKeyframe(points);
  }
  return step;
}

/// Matches with the local map; a scan that does not fit is searched around the pose.
IcpResult ScanOdometry::match(const SurfacePoints& points, const Pose2& motion) {
  const Eigen::Matrix3d information = odometryInformation(motion);
  IcpResult best = alignIcp(points, local_map_, pose_, information, params_.refine);
  if (best.matched >= params_.min_inlier_ratio || points.size() <= kMinSearchPoints ||
      local_map_.empty()) {
    return best;
  }
  // What a search did not find it does not find a step farther, unless the scan fits still worse.
  const bool again = searched_in_vain_ && best.matched > searched_in_vain_->inlier_ratio - 0.1 &&
                     isWithin(between(searched_in_vain_->pose, pose_), params_.keyframe_step,
                              params_.keyframe_turn);
  if (again) return best;
  searched_in_vain_ = InVain{pose_, best.matched};
  CorrelativeMatcherParams search;
  search.linear_window = params_.search_window;
  search.angular_window = params_.search_angle;
  search.min_score = params_.search_min_score;
  if (const auto found =
          CorrelativeMatcher(local_map_, search, points, pose_).match(points, pose_)) {
    const IcpResult better = alignIcp(points, local_map_, found->pose,
                                      kSearchedOdometryScale * information, params_.refine);
    if (better.matched > best.matched + params_.search_min_gain) {
      best = better;
      searched_in_vain_.reset();
    }
  }
  return best;
}

}  // namespace hyselam_scan_matching

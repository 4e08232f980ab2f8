#include "ngram_slam/slam/slam_engine.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "hyselam_scan_matching/icp.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;
using hyselam_scan_matching::CorrelativeMatcher;
using hyselam_scan_matching::IcpResult;
using hyselam_scan_matching::SurfaceMap;
using hyselam_scan_matching::SurfacePoints;

namespace {

constexpr double kFarthest = 0.99e7;    // [m] cells beyond 10^7 m have no number in the local maps
constexpr double kFarthestLaser = 5.0;  // [m] it must lie on the local map of the words' sensor

void check(const hyselam::LaserScan& scan, const Pose2& odometry) {
  const std::string place = "scan at " + std::to_string(scan.stamp) + " s";
  if (!std::isfinite(scan.stamp)) throw hyselam::InputError("scan", "", "its time is not finite");
  if (!odometry.isFinite()) throw hyselam::InputError("odometry", place, "is not finite");
  if (std::max(std::abs(odometry.x), std::abs(odometry.y)) > kFarthest)
    throw hyselam::InputError("odometry", place, "is more than 10000 km from its origin");
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      !std::isfinite(scan.range_min) || std::isnan(scan.range_max) ||
      !scan.laser_in_base.isFinite())
    throw hyselam::InputError("scan", place, "its geometry is not finite");
  if (std::hypot(scan.laser_in_base.x, scan.laser_in_base.y) > kFarthestLaser)
    throw hyselam::InputError("scan", place, "the laser is more than 5 m from the base");
  if (!scan.ranges.empty() && scan.angle_increment == 0.0)
    throw hyselam::InputError("scan", place, "all beams have one bearing: angle_increment is 0");
}

SlamParams checked(const SlamParams& p) {
  p.validate();
  return p;
}

}  // namespace

SlamEngine::SlamEngine(const SlamParams& params) : SlamEngine(params, SlamState{}) {}

SlamEngine::SlamEngine(const SlamParams& params, SlamState state)
    : params_(checked(params)),
      state_((state.validate(), std::move(state))),
      words_(params.observations, params.words, std::move(state_.corpus)),
      local_(params.local_cell) {
  state_.corpus = {};
  relearnWays();
  if (state_.keyframes.empty()) return;
  const SlamKeyframe& last = state_.keyframes.back();
  way_ = last.way;
  far_searched_ = way_;
  pose_ = matched_pose_ = last.pose;
  odometry_ = matched_odometry_ = last.odometry;
  if (!state_.scans.empty() &&
      state_.scans.back().keyframe + 1 == static_cast<int>(state_.keyframes.size()))
    pose_ = last.pose * state_.scans.back().base_in_keyframe;
  optimised_keyframes_ = static_cast<int>(state_.keyframes.size());
}

SlamState SlamEngine::state() const {
  SlamState s = state_;
  s.corpus = words_.recogniser().corpus();
  return s;
}

Pose2 SlamEngine::odomInMap() const {
  return pose_ * odometry_.inverse();
}

SlamUpdate SlamEngine::add(const hyselam::LaserScan& scan, const Pose2& odometry) {
  check(scan, odometry);
  if (run_open_ && scan.stamp <= last_stamp_)
    throw hyselam::InputError(
        "scan", std::to_string(scan.stamp) + " s",
        "does not come after the last one, " + std::to_string(last_stamp_) + " s");
  SlamUpdate update;
  ++state_.counters.scans;
  last_stamp_ = scan.stamp;
  if (!run_open_) {
    startAt(scan, odometry);
    update.keyframe = true;
    update.base_in_map = pose_;
    return update;
  }
  Pose2 motion = between(matched_odometry_, odometry);
  if (hyselam::distance(odometry_, odometry) > params_.longest_step) {
    update.leap = true;
    ++state_.counters.leaps;
    motion = between(matched_odometry_, odometry_);
  }
  const Pose2 step = update.leap ? Pose2{} : between(odometry_, odometry);
  way_ += std::hypot(step.x, step.y);
  odometry_ = odometry;
  pose_ = matched_pose_ * motion;
  const auto last = static_cast<int>(state_.keyframes.size()) - 1;
  if (!update.leap && std::hypot(motion.x, motion.y) < params_.scan_step &&
      std::abs(motion.theta) < params_.scan_turn) {
    state_.scans.push_back({scan.stamp, last, between(state_.keyframes.back().pose, pose_)});
    update.base_in_map = pose_;
    return update;
  }

  const auto points = std::make_shared<const SurfacePoints>(surfacePoints(scan, params_.surface));
  const Eigen::Matrix3d believed =
      update.leap ? Eigen::Matrix3d(Eigen::Vector3d(0.1, 0.1, 0.1).asDiagonal())
                  : params_.odometry.information(motion);
  Eigen::Matrix3d seen = Eigen::Matrix3d::Zero();
  if (params_.refine_odometry) {
    const IcpResult r = matchLocally(*points, believed, &update);
    seen = r.information;
    pose_ = r.pose;
  }
  const Pose2 refined = between(matched_pose_, pose_);
  smooth_ = smooth_ * refined;
  matched_pose_ = pose_;
  matched_odometry_ = odometry;

  const Pose2 from_keyframe = between(state_.keyframes.back().pose, pose_);
  if (!update.leap && std::hypot(from_keyframe.x, from_keyframe.y) < params_.keyframe_step &&
      std::abs(from_keyframe.theta) < params_.keyframe_turn) {
    state_.scans.push_back({scan.stamp, last, from_keyframe});
  } else {
    PoseEdge edge;
    edge.from = last;
    edge.to = last + 1;
    edge.measured = from_keyframe;
    const Eigen::Matrix3d odometer =
        update.leap ? believed : params_.odometry.information(from_keyframe);
    edge.information = params_.refine_odometry
                           ? Eigen::Matrix3d(params_.scan_information * seen + 0.5 * odometer)
                           : odometer;
    edge.information = (0.5 * (edge.information + edge.information.transpose())).eval();
    addKeyframe(scan, points, &edge);
    update.keyframe = true;
    lookAround();
  }
  if (usesWords()) {
    const std::size_t before = state_.matches.size();
    takeWords(words_.add(scan, smooth_));
    update.words =
        static_cast<int>(state_.matches.size() - std::min(before, state_.matches.size()));
  }
  update.base_in_map = pose_;
  return update;
}

hyselam_scan_matching::IcpResult SlamEngine::matchLocally(const SurfacePoints& points,
                                                          const Eigen::Matrix3d& believed,
                                                          SlamUpdate* update) {
  ++state_.counters.matched;
  IcpResult r = alignIcp(points, local_, pose_, believed, params_.refine);
  constexpr std::size_t kEnough = 30;
  if (r.matched < params_.lost && points.size() > kEnough && !local_.empty()) {
    hyselam_scan_matching::CorrelativeMatcherParams s;
    s.linear_window = 0.6;
    s.angular_window = 0.35;
    s.min_score = 0.4;
    if (const auto found = CorrelativeMatcher(local_, s).match(points, pose_)) {
      const IcpResult again =
          alignIcp(points, local_, found->pose, 0.05 * believed, params_.refine);
      if (again.matched > r.matched + 0.1) {
        r = again;
        ++state_.counters.searched;
      }
    }
  }
  if (r.matched < 0.8 * params_.lost) {
    update->weak = true;
    ++state_.counters.weak;
  }
  return r;
}

void SlamEngine::startRun(const Pose2& base_in_map, double window, double turn) {
  if (!base_in_map.isFinite()) throw hyselam::ParameterError("base_in_map", "not finite", "finite");
  if (!(window > 0.0 && window <= kMaxStartWindow))
    throw hyselam::ParameterError("window", window, "above 0, at most 50 m");
  if (!(turn >= 0.0 && turn <= hyselam::kPi))
    throw hyselam::ParameterError("turn", turn, "from 0 to pi");
  endRun();
  start_ = Start{base_in_map, window, turn};
}

void SlamEngine::endRun() {
  if (!run_open_) return;
  if (usesWords()) takeWords(words_.finish());
  run_open_ = false;
}

void SlamEngine::startAt(const hyselam::LaserScan& scan, const Pose2& odometry) {
  const auto points = std::make_shared<const SurfacePoints>(surfacePoints(scan, params_.surface));
  odometry_ = matched_odometry_ = odometry;
  smooth_ = odometry;
  first_of_run_ = static_cast<int>(state_.keyframes.size());
  if (first_of_run_ == 0) {
    pose_ = start_ ? start_->pose : odometry;
    addKeyframe(scan, points, nullptr);
  } else {
    const Start start = start_.value_or(Start{pose_, 1.0, 0.5});
    pose_ = start.pose;
    // What was seen around there.
    const auto near = [&](const SlamKeyframe& k) { return distance(k.pose, start.pose); };
    std::vector<int> around;
    for (int k = 0; k < first_of_run_; ++k)
      if (near(state_.keyframes[static_cast<std::size_t>(k)]) < 10.0 + start.window)
        around.push_back(k);
    const auto nearest = std::min_element(
        state_.keyframes.begin(), state_.keyframes.end(),
        [&](const SlamKeyframe& a, const SlamKeyframe& b) { return near(a) < near(b); });
    SlamLoop tie;
    tie.older = static_cast<int>(nearest - state_.keyframes.begin());
    tie.newer = first_of_run_;
    tie.information = Eigen::Vector3d(1.0, 1.0, 10.0).asDiagonal();
    SurfaceMap map(params_.local_cell);
    for (const int k : around) {
      const SlamKeyframe& old = state_.keyframes[static_cast<std::size_t>(k)];
      map.insert(old.pose, *old.points);
    }
    map.finish();
    hyselam_scan_matching::CorrelativeMatcherParams s;
    s.linear_window = start.window;
    s.angular_window = start.turn;
    s.min_score = 0.4;
    if (const auto found = CorrelativeMatcher(map, s).match(*points, start.pose)) {
      const IcpResult r =
          alignIcp(*points, map, found->pose, Eigen::Matrix3d::Zero(), params_.refine);
      if (r.matched >= params_.lost) {
        pose_ = r.pose;
        tie.matched = r.matched;
        tie.information += params_.scan_information * r.information;
        tie.information = (0.5 * (tie.information + tie.information.transpose())).eval();
      }
    }
    tie.measured = between(nearest->pose, pose_);
    addKeyframe(scan, points, nullptr);
    accept(tie);
  }
  matched_pose_ = pose_;
  start_.reset();
  run_open_ = true;
  if (usesWords()) takeWords(words_.add(scan, smooth_));
}

void SlamEngine::addKeyframe(const hyselam::LaserScan& scan,
                             std::shared_ptr<const SurfacePoints> points, const PoseEdge* edge) {
  SlamKeyframe k;
  k.stamp = scan.stamp;
  k.odometry = odometry_;
  k.pose = pose_;
  k.way = way_;
  k.run = state_.keyframes.empty() ? 0 : state_.keyframes.back().run;
  if (edge == nullptr && !state_.keyframes.empty()) ++k.run;
  k.scan = std::make_shared<const hyselam::LaserScan>(scan);
  k.points = std::move(points);
  state_.keyframes.push_back(std::move(k));
  state_.scans.push_back({scan.stamp, static_cast<int>(state_.keyframes.size()) - 1, {}});
  if (edge != nullptr) {
    state_.odometry.push_back(*edge);
    ways_.add(edge->from, edge->to, std::hypot(edge->measured.x, edge->measured.y));
  }
  rebuildLocalMap();
}

void SlamEngine::rebuildLocalMap() {
  local_ = SurfaceMap(params_.local_cell);
  const auto n = static_cast<int>(state_.keyframes.size());
  const int first = std::max(first_of_run_, n - params_.local_keyframes);
  const auto insert = [&](int k) {
    const SlamKeyframe& keyframe = state_.keyframes[static_cast<std::size_t>(k)];
    local_.insert(keyframe.pose, *keyframe.points);
  };
  // A run that has only begun sees what others saw there.
  if (first_of_run_ > 0 && n - first < params_.local_keyframes)
    for (int k = 0; k < first_of_run_; ++k)
      if (distance(state_.keyframes[static_cast<std::size_t>(k)].pose,
                   state_.keyframes.back().pose) < 3.0)
        insert(k);
  for (int k = first; k < n; ++k) insert(k);
  local_.finish();
}

hyselam_pose_graph::PoseGraph SlamEngine::graph() const {
  hyselam_pose_graph::PoseGraph g;
  for (std::size_t i = 0; i < state_.keyframes.size(); ++i) {
    g.ids.push_back(static_cast<std::int64_t>(i));
    g.poses.push_back(state_.keyframes[i].pose);
  }
  g.edges = state_.odometry;
  for (const SlamLoop& l : state_.loops)
    g.edges.push_back({l.older, l.newer, l.measured, l.information});
  return g;
}

std::vector<hyselam::StampedPose2> SlamEngine::trajectory() const {
  std::vector<hyselam::StampedPose2> out;
  out.reserve(state_.scans.size());
  for (const PlacedScan& s : state_.scans)
    out.push_back({s.stamp, state_.keyframes[static_cast<std::size_t>(s.keyframe)].pose *
                                s.base_in_keyframe});
  return out;
}

}  // namespace ngram_slam

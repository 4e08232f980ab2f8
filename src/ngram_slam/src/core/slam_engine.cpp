#include "ngram_slam/slam_engine.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_scan_matching/refine.hpp"
#include "hyselam_scan_matching/search.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;
using hyselam_scan_matching::Refined;
using hyselam_scan_matching::SearchGrid;
using hyselam_scan_matching::SurfaceMap;
using hyselam_scan_matching::SurfacePoints;

namespace {

void check(const hyselam::LaserScan& scan, const Pose2& odometry) {
  const std::string place = "scan at " + std::to_string(scan.stamp) + " s";
  if (!std::isfinite(scan.stamp)) throw hyselam::InputError("scan", "", "its time is not finite");
  if (!odometry.isFinite()) throw hyselam::InputError("odometry", place, "is not finite");
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      !std::isfinite(scan.range_min) || std::isnan(scan.range_max) ||
      !scan.laser_in_base.isFinite())
    throw hyselam::InputError("scan", place, "its geometry is not finite");
  if (!scan.ranges.empty() && scan.angle_increment == 0.0)
    throw hyselam::InputError("scan", place, "all beams have one bearing: angle_increment is 0");
}

void checkState(const SlamState& s) {
  const auto n = static_cast<int>(s.keyframes.size());
  const auto known = [n](int k) { return k >= 0 && k < n; };
  for (const SlamKeyframe& k : s.keyframes)
    if (!k.scan || !k.points || !k.pose.isFinite() || !k.odometry.isFinite())
      throw std::invalid_argument("SLAM state: a keyframe lacks its scan or pose");
  for (const PlacedScan& p : s.scans)
    if (!known(p.keyframe)) throw std::invalid_argument("SLAM state: a scan has no keyframe");
  for (const auto* loops : {&s.loops, &s.waiting})
    for (const SlamLoop& l : *loops)
      if (!known(l.older) || !known(l.newer) || l.older == l.newer)
        throw std::invalid_argument("SLAM state: a loop without keyframes");
  for (const PoseEdge& e : s.odometry)
    if (!known(e.from) || !known(e.to))
      throw std::invalid_argument("SLAM state: an edge without keyframes");
  if (s.keyframe_of_observation.size() != s.corpus.observations.size())
    throw std::invalid_argument("SLAM state: observations and their keyframes differ in number");
  for (const std::int32_t k : s.keyframe_of_observation)
    if (!known(k)) throw std::invalid_argument("SLAM state: an observation has no keyframe");
}

SlamParams checked(const SlamParams& p) {
  p.validate();
  return p;
}

}  // namespace

SlamEngine::SlamEngine(const SlamParams& params) : SlamEngine(params, SlamState{}) {}

SlamEngine::SlamEngine(const SlamParams& params, SlamState state)
    : params_(checked(params)),
      state_((checkState(state), std::move(state))),
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
    const Refined r = matchLocally(*points, believed, &update);
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

hyselam_scan_matching::Refined SlamEngine::matchLocally(const SurfacePoints& points,
                                                        const Eigen::Matrix3d& believed,
                                                        SlamUpdate* update) {
  ++state_.counters.matched;
  Refined r = refine(points, local_, pose_, believed, params_.refine);
  constexpr std::size_t kEnough = 30;
  if (r.matched < params_.lost && points.size() > kEnough && !local_.empty()) {
    hyselam_scan_matching::SearchParams s;
    s.window = 0.6;
    s.turn = 0.35;
    s.least_score = 0.4;
    if (const auto found = SearchGrid(local_, s).search(points, pose_)) {
      const Refined again = refine(points, local_, found->pose, 0.05 * believed, params_.refine);
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
  run_open_ = true;
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
    hyselam_scan_matching::SearchParams s;
    s.window = start.window;
    s.turn = start.turn;
    s.least_score = 0.4;
    if (const auto found = SearchGrid(map, s).search(*points, start.pose)) {
      const Refined r = refine(*points, map, found->pose, Eigen::Matrix3d::Zero(), params_.refine);
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

std::optional<SlamJob> SlamEngine::takeJob() {
  return job(false);
}
std::optional<SlamJob> SlamEngine::takeLastJob() {
  return job(true);
}

std::optional<SlamJob> SlamEngine::job(bool last) {
  if (job_out_) return std::nullopt;
  SlamJob j;
  const auto n = static_cast<int>(state_.keyframes.size());
  if (!tasks_.empty()) {
    j.tasks.swap(tasks_);
  } else if (dirty_ && (last || urgent_ || n - optimised_keyframes_ >= params_.optimise_every)) {
    j.graph = graph();
    dirty_ = urgent_ = false;
    optimised_keyframes_ = n;
  } else {
    return std::nullopt;
  }
  j.params = params_;
  job_out_ = true;
  return j;
}

namespace {

using hyselam_pose_graph::GraphOptimizer;
using hyselam_pose_graph::GraphRobust;
using hyselam_pose_graph::GraphStart;
using hyselam_pose_graph::OptimizeParams;
using hyselam_pose_graph::OptimizeResult;

std::size_t believed(const OptimizeResult& r) {
  return static_cast<std::size_t>(
      std::count_if(r.weights.begin(), r.weights.end(), [](double w) { return w >= 0.3; }));
}

/// From the poses as they are. A loop that closes after hundreds of metres looks wrong from there,
/// however right it is: where loops would lose their weight, all are followed first, and the poses
/// that are found so are kept if more of the loops are believed there.
OptimizeResult optimise(hyselam_pose_graph::PoseGraph graph, const SlamParams& params) {
  OptimizeParams p;
  p.start = GraphStart::kGiven;
  p.dcs_phi = params.dcs_phi;
  p.robust = params.loops == SlamLoops::kThesis ? GraphRobust::kNone : GraphRobust::kDcs;
  OptimizeResult result = GraphOptimizer(graph).optimize(p);
  if (p.robust == GraphRobust::kNone || believed(result) == graph.edges.size()) return result;
  OptimizeParams all = p;
  all.start = GraphStart::kChordal;
  all.robust = GraphRobust::kNone;
  graph.poses = GraphOptimizer(graph).optimize(all).poses;
  OptimizeResult other = GraphOptimizer(std::move(graph)).optimize(p);
  return believed(other) > believed(result) ? other : result;
}

}  // namespace

SlamJobResult runJob(const SlamJob& job) {
  SlamJobResult result;
  for (const LoopTask& task : job.tasks) {
    result.answers.push_back(verifyLoop(task, job.params));
    LoopTask asked = task;
    asked.old_stretch.clear();
    asked.new_stretch.clear();
    result.tasks.push_back(std::move(asked));
  }
  if (job.graph) result.optimised = optimise(*job.graph, job.params);
  return result;
}

void SlamEngine::apply(const SlamJobResult& result) {
  job_out_ = false;
  for (std::size_t i = 0; i < result.tasks.size() && i < result.answers.size(); ++i)
    takeAnswer(result.tasks[i], result.answers[i]);
  if (!result.optimised || result.optimised->poses.empty()) return;
  const auto& optimised = *result.optimised;
  const std::size_t n = optimised.poses.size();
  // What came since moves along with the last pose that was optimised.
  const Pose2 moved = optimised.poses[n - 1] * state_.keyframes[n - 1].pose.inverse();
  for (std::size_t i = 0; i < state_.keyframes.size(); ++i) {
    Pose2& pose = state_.keyframes[i].pose;
    pose = i < n ? optimised.poses[i] : moved * pose;
  }
  pose_ = moved * pose_;
  matched_pose_ = moved * matched_pose_;
  for (std::size_t i = state_.odometry.size() - (state_.keyframes.size() - n), l = 0;
       l < state_.loops.size() && i < optimised.weights.size(); ++i, ++l)
    state_.loops[l].weight = optimised.weights[i];
  relearnWays();
  rebuildLocalMap();
  ++state_.counters.optimisations;
  ++revision_;
}

}  // namespace ngram_slam

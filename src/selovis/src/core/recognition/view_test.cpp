#include "selovis/recognition/view_test.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace selovis {
namespace {

// The kernel regression of looks, as in PoseFilterParams.
constexpr double kRadius = 2.0;                         // [m]
constexpr double kAngle = 18.0 * hyselam::kPi / 180.0;  // [rad]
constexpr double kBeta = 1.5;
constexpr double kPriorWeight = 3.0;

constexpr double kHalfLearned = 1.0;  // weight of the kernels that is a coverage of one half
constexpr double kMaxRatio = 8.0;     // [nats] of one look, camera and scan together
constexpr double kCameraGain = 2.0;
// Independent returns of a scan; differences of its fit are multiplied by it.
constexpr double kScanGain = 10.0;
// Fit that a right pose may lack: somebody who stands before the laser hides an eighth of the view.
constexpr double kForgiven = 0.3;

// How much rarer evidence is at right poses than the ratios say [nats], measured; see
// docs/algorithms/visual_places.md.
constexpr double kCalibration = 3.0;
constexpr double kLeastThreshold = 1.0;  // [nats]

constexpr std::size_t kViewsTried = 40;  // the most similar ones elsewhere
constexpr std::size_t kRivalsAdded = 3;  // by one frame, at most
constexpr std::size_t kMaxRivals = 8;
constexpr double kSameRival = 1.5;      // [m]
constexpr double kSameRivalTurn = 0.6;  // [rad]
constexpr double kOverThreshold = 4.0;  // [nats] that evidence may exceed the threshold by

// Where the scan may be aligned: about a new rival, and about a pose that is known.
constexpr double kNewReach = 1.0, kNewTurn = 20.0 * hyselam::kPi / 180.0;
constexpr double kKnownReach = 0.25, kKnownTurn = 5.0 * hyselam::kPi / 180.0;

// A rejected pose was right after all if the odometry's frame lies as it did.
constexpr double kSameOdometry = 0.75, kSameOdometryTurn = 0.35;

bool isNear(const hyselam::Pose2& a, const hyselam::Pose2& b, double reach, double turn) {
  return hyselam::distance(a, b) < reach &&
         std::abs(hyselam::normalizeAngle(a.theta - b.theta)) < turn;
}

}  // namespace

void ViewTestParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("false_alarm_hours", false_alarm_hours, Range::between(0.01, 1e5), "h",
        "wanted time between two false alarms, while the pose is right");
  visit("correlation_time", correlation_time, Range::between(0.01, 10.0), "s",
        "looks nearer in time are one look");
  visit("proven_after", proven_after, Range::between(1.0, 600.0), "s",
        "looks count as those of a right pose once the pose was kept so much longer");
  visit("remember", remember, "where the camera errs at poses that proved right");
}

double ViewTest::thresholdFor(double hours, double correlation_time) {
  // exp(threshold) looks between two false alarms, were looks independent and ratios exact (Lorden
  // 1971); measured at right poses there are fewer by kCalibration.
  return std::max(kLeastThreshold, std::log(hours * 3600.0 / correlation_time) - kCalibration);
}

ViewTest::ViewTest(const Samples& samples, const ViewTestParams& params, ReliabilityMemory memory)
    : params_(params),
      threshold_(thresholdFor(params.false_alarm_hours, params.correlation_time)),
      views_(samples, kRadius, kAngle),
      memory_(std::move(memory)) {}

void ViewTest::reset() {
  rivals_.clear();
  pending_.clear();
  last_base_.reset();
  last_odometry_.reset();
}

void ViewTest::reject() {
  Rejected rejected{std::move(pending_), {}};
  if (last_base_ && last_odometry_) {
    rejected.odom_in_map = *last_base_ * last_odometry_->inverse();
  }
  rejected_ = std::move(rejected);
  pending_.clear();
}

bool ViewTest::isElsewhere(const hyselam::Pose2& a, const hyselam::Pose2& b) const {
  return !isNear(a, b, kElsewhere, kElsewhereTurn);
}

double ViewTest::likelihoodAt(const hyselam::Pose2& camera, LearnedViews::Regression* seen) const {
  *seen = views_.at(camera);
  return (kPriorWeight * mean_ + seen->sum) / (kPriorWeight + seen->weight);
}

void ViewTest::moveRivals(const ViewTestFrame& frame) {
  hyselam::Pose2 motion;
  if (frame.odometry && last_odometry_) {
    motion = hyselam::between(*last_odometry_, *frame.odometry);
  } else if (last_base_) {
    motion = hyselam::between(*last_base_, *frame.base);
  }
  for (RivalPose& r : rivals_) r.base = r.base * motion;
  last_base_ = frame.base;
  last_odometry_ = frame.odometry;
}

void ViewTest::addRivals(const ViewTestFrame& frame, const hyselam::Pose2& camera) {
  views_.mostSimilar(
      kViewsTried,
      [&](const LearnedViews::View& v) { return isElsewhere(views_.poseOf(v), camera); }, &order_);
  std::vector<std::pair<double, hyselam::Pose2>> found;
  for (const std::uint32_t v : order_) {
    const hyselam::Pose2 pose = views_.poseOf(views_.views()[v]);
    LearnedViews::Regression seen;
    found.emplace_back(likelihoodAt(pose, &seen), pose);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const hyselam::Pose2 base_in_camera = frame.camera_in_base.inverse();
  std::vector<hyselam::Pose2> added;
  for (const auto& [likelihood, pose] : found) {
    if (added.size() == kRivalsAdded) break;
    const hyselam::Pose2 base = pose * base_in_camera;
    const auto known = [&](const hyselam::Pose2& other) {
      return isNear(other, base, kSameRival, kSameRivalTurn);
    };
    if (std::any_of(added.begin(), added.end(), known)) continue;
    added.push_back(base);
    if (std::any_of(rivals_.begin(), rivals_.end(),
                    [&](const RivalPose& r) { return known(r.base); })) {
      continue;
    }
    RivalPose rival;
    rival.base = base;
    if (fit_ != nullptr && frame.scan != nullptr) {
      rival.base = fit_->best(*frame.scan, base, kNewReach, kNewTurn).base;
      rival.by_scan = true;
    }
    rivals_.push_back(rival);
  }
}

void ViewTest::remember(const ViewTestFrame& frame, double looks, const std::vector<int>& places) {
  pending_.push_back({clock_, *frame.base, places, looks});
  while (!pending_.empty() && clock_ - pending_.front().at > params_.proven_after) {
    if (rejected_ && frame.odometry && rejected_->odom_in_map) {
      const hyselam::Pose2 odom_in_map = *frame.base * frame.odometry->inverse();
      if (isNear(odom_in_map, *rejected_->odom_in_map, kSameOdometry, kSameOdometryTurn)) {
        for (const Look& l : rejected_->looks) memory_.add(l.pose, l.places, l.looks);
      }
    }
    rejected_.reset();
    const Look& l = pending_.front();
    memory_.add(l.pose, l.places, l.looks);
    pending_.pop_front();
  }
}

std::vector<int> ViewTest::weighRivals(const ViewTestFrame& frame, double looks, double at_pose,
                                       ViewTestState& state) {
  const bool scanned = fit_ != nullptr && frame.scan != nullptr;
  const double scan_at_pose =
      scanned ? fit_->best(*frame.scan, *frame.base, kKnownReach, kKnownTurn).fit : 0.0;
  double lead = -1.0;
  std::set<int> spoken_for;
  for (RivalPose& r : rivals_) {
    double by_scan = 0.0;
    if (scanned) {
      const FittedPose fitted = fit_->best(*frame.scan, r.base, kKnownReach, kKnownTurn);
      r.base = fitted.base;
      r.by_scan = true;
      by_scan = kScanGain * (fitted.fit - std::min(0.0, scan_at_pose + kForgiven));
    }
    LearnedViews::Regression there;
    const double ratio = std::log(likelihoodAt(r.base * frame.camera_in_base, &there) / at_pose);
    r.place = there.place;
    double by_camera = state.coverage * kCameraGain * ratio;
    if (params_.remember && by_camera > 0.0 && r.place >= 0) {
      by_camera = std::min(by_camera, -std::log(memory_.errorRate(*frame.base, r.place)));
      spoken_for.insert(r.place);
    }
    r.log_ratio = std::clamp(by_camera + by_scan, -kMaxRatio, kMaxRatio);
    r.evidence = std::clamp(r.evidence + looks * r.log_ratio, 0.0, threshold_ + kOverThreshold);
    if (r.evidence > lead) {
      lead = r.evidence;
      state.increment = looks * r.log_ratio;
    }
  }
  return {spoken_for.begin(), spoken_for.end()};
}

void ViewTest::dropRivals(const hyselam::Pose2& base) {
  rivals_.erase(std::remove_if(rivals_.begin(), rivals_.end(),
                               [&](const RivalPose& r) {
                                 return r.evidence <= 0.0 ||
                                        isNear(r.base, base, kSameRival, kSameRivalTurn);
                               }),
                rivals_.end());
  std::stable_sort(rivals_.begin(), rivals_.end(),
                   [](const RivalPose& a, const RivalPose& b) { return a.evidence > b.evidence; });
  // Two that have met are one.
  for (std::size_t i = 0; i < rivals_.size(); ++i) {
    rivals_.erase(
        std::remove_if(rivals_.begin() + static_cast<std::ptrdiff_t>(i) + 1, rivals_.end(),
                       [&](const RivalPose& r) {
                         return isNear(r.base, rivals_[i].base, kSameRival, kSameRivalTurn);
                       }),
        rivals_.end());
  }
  if (rivals_.size() > kMaxRivals) rivals_.resize(kMaxRivals);
}

ViewTestState ViewTest::update(const ViewTestFrame& frame) {
  const double seconds = std::max(0.0, frame.seconds);
  clock_ += seconds;
  ViewTestState state;
  const double total = views_.compare(*frame.distances, kBeta);
  if (!frame.base || !frame.base->isFinite()) {
    reset();
    return state;
  }
  state.tested = true;
  mean_ = total / static_cast<double>(views_.views().size());
  moveRivals(frame);
  const hyselam::Pose2 camera = *frame.base * frame.camera_in_base;
  LearnedViews::Regression seen;
  const double at_pose = likelihoodAt(camera, &seen);
  state.coverage = seen.weight / (seen.weight + kHalfLearned);
  addRivals(frame, camera);
  const double looks = std::min(1.0, seconds / params_.correlation_time);
  const std::vector<int> spoken_for = weighRivals(frame, looks, at_pose, state);
  if (params_.remember) remember(frame, looks, spoken_for);
  dropRivals(*frame.base);
  if (!rivals_.empty()) {
    state.evidence = rivals_.front().evidence;
    const double next = rivals_.size() > 1 ? rivals_[1].evidence : 0.0;
    if (state.evidence - next >= kRivalLead) state.rival = rivals_.front();
  }
  return state;
}

}  // namespace selovis

// The localizer's decisions by the search of whole maps: what is believed, and when it is not any
// more.
#include <algorithm>
#include <cmath>

#include "fsd_localization/localizer.hpp"

namespace fsd_localization {

using hyselam::Pose2;

namespace {

constexpr double kSupposedVariance = 1.0;  // [m^2], along each axis, at least
constexpr double kAskStep = 0.5;           // [m] between questions of a robot that is not found
constexpr double kLargestAlarmStep = 4.0;  // [m] between those about an alarm that was found false
constexpr double kAlarmLength = 2.0;       // [m] of scans at most that an alarm is about
constexpr double kFirstCheck = 2.0;        // [m] after a place was found, and then twice as far
constexpr double kCheckStep = 30.0;        // [m] at most between checks
constexpr double kOneScan = 0.3;           // [m] a shorter submap is a scan, or as good as one
constexpr double kUsual = 0.75;            // of the usual share of inliers, that confirms a pose
constexpr double kFits = 0.3;    // a place with a lower score does not explain what is seen
constexpr double kLikely = 0.5;  // probability from which on a search confirms a pose
constexpr Pose2 kPlaceStddev{0.1, 0.1, hyselam::radians(3.0)};
constexpr std::uint64_t kPlaceStream = 0x91ace5;

}  // namespace

void Localizer::forgetSearch() {
  search_.submap.reset();
  if (search_.background) search_.background->drop();
  search_.asked_at.reset();
  search_.verdict.reset();
  search_.suspicious_until = -1.0;
  search_.alarm_from.reset();
  search_.suspicious_for = 0.0;
  search_.confirmed = search_.strange = search_.low = search_.carried = false;
  search_.rival.reset();
  search_.guided = false;
}

/// While tracking: whether something speaks against the pose, and whether it is told as sure.
void Localizer::watchForAlarms(LocalizationResult& result) {
  search_.suspicious_until =
      std::max(search_.suspicious_until, search_.way + search_.suspicious_for);
  search_.suspicious_for = 0.0;
  const bool suspicious = search_.way < search_.suspicious_until;
  // The last scans fit neither each other nor the map.
  const bool strange = suspicious && !inliers_.isUsual(kUsual);
  const bool low = inliers_.isBelow(params_.lost_inlier_ratio, params_.lost_relative_ratio);
  const bool begins = strange && !search_.strange;  // perhaps elsewhere: a new alarm
  if ((!suspicious && !low) || begins) {
    search_.alarm_from.reset();
    search_.confirmed = search_.carried = false;
  }
  if ((suspicious || low) && !search_.alarm_from) {
    search_.alarm_from = search_.asked_at = search_.way;  // one that the map confirms can wait
    search_.alarm_step = kAskStep;
  }
  if (begins || (low && !search_.low)) {  // what is asked by now is out of date
    search_.asked_at.reset();
    search_.background->drop();
  }
  search_.carried = search_.carried || strange;
  search_.strange = strange;
  search_.low = low;
  // Meanwhile nobody should rely on the pose, unless a search has confirmed it; but the robot is
  // not lost before another place is better.
  if (!search_.confirmed &&
      (strange || search_.rival || inliers_.isBelow(params_.lost_inlier_ratio, 0.0))) {
    result.converged = false;
  }
}

void Localizer::updateBySearch(const PoseEstimate& estimate, double motion,
                               LocalizationResult& result) {
  const bool tracking = state_ == LocalizerState::kTracking;
  if (!isSearching(state_)) {
    result.inlier_ratio =
        likelihood_model_->inlierRatio(observation_.scan, estimate.mean, params_.inlier_distance);
    inliers_.add(result.inlier_ratio, motion);
  }
  if (tracking) {
    watchForAlarms(result);
  } else if (search_.guided && result.converged &&
             inliers_.average() >= params_.found_inlier_ratio) {
    search_.guided = false;
    search_.tracked_from = search_.way;
    search_.next_check = kFirstCheck;
    startTracking();
  } else {
    result.converged = false;
  }
  takeAnswer(result);
  // A place that is only supposed, the only one that fits, does not look certain.
  if (!result.converged && state_ != LocalizerState::kTracking) {
    result.covariance(0, 0) = std::max(result.covariance(0, 0), kSupposedVariance);
    result.covariance(1, 1) = std::max(result.covariance(1, 1), kSupposedVariance);
  }
  askSearch(estimate);
  if (search_.verdict) {
    result.place_probability = search_.verdict->probability;
    result.places = search_.verdict->best.seen < kFits
                        ? 0
                        : static_cast<int>(search_.verdict->hypotheses.size());
  }
}

/// What was seen before an alarm may belong to another place.
double Localizer::lengthOfAlarm() const {
  return search_.alarm_from ? std::min(kAlarmLength, search_.way - *search_.alarm_from)
                            : kAlarmLength;
}

/// Asks when there is a reason to: not found yet; an alarm; a place found lately.
void Localizer::askSearch(const PoseEstimate& estimate) {
  if (search_.background->busy() || search_.submap.empty()) return;
  const double since = search_.asked_at ? search_.way - *search_.asked_at : kAskStep;
  if (since < kAskStep) return;
  double length = SubmapBuilder::kMaxLength, turn_as_travel = 0.0;
  std::optional<Pose2> believed;
  if (state_ == LocalizerState::kTracking) {
    const bool alarm = search_.alarm_from.has_value();
    const bool check = search_.way - search_.tracked_from >= search_.next_check;
    const bool again =
        search_.rival || (alarm && (!search_.asked_at || since >= search_.alarm_step));
    if (!check && !again) return;
    if (check) search_.next_check += std::min(search_.next_check, kCheckStep);
    if (alarm) {
      length = lengthOfAlarm();
      turn_as_travel = kTurnAsTravel;
    }
    believed = estimate.mean;
  } else if (search_.guided) {
    believed = estimate.mean;
  }
  search_.asked_at = search_.way;
  search_.background->ask(observation_.scan.stamp, *updated_odom_,
                          search_.submap.build(length, turn_as_travel), believed);
}

void Localizer::takeAnswer(LocalizationResult& result) {
  const auto answer = search_.background->take(observation_.scan.stamp, wait_for_search_);
  if (!answer) return;
  search_.verdict = judge(*answer, params_.place_odds);
  if (search_.verdict) decide(*answer, *search_.verdict, result);
}

void Localizer::decide(const SearchAnswer& answer, const Verdict& verdict,
                       LocalizationResult& result) {
  const Pose2 motion = between(answer.base_in_odom, *updated_odom_);
  if (state_ == LocalizerState::kTracking) {
    if (!answer.believed) return;  // asked before
    if (!verdict.is_believed && verdict.probability >= params_.lost_probability) {
      // A single scan was odd, and those after it are not.
      if (answer.length < kOneScan && inliers_.isUsual(params_.lost_relative_ratio)) return;
      if (!isContradicted(answer, verdict)) {
        result.converged = false;
        return;
      }
      state_ = LocalizerState::kLostSearch;
      search_.submap.keepLast(lengthOfAlarm(), kTurnAsTravel);
      followPlaces(verdict.hypotheses, motion);
      result.converged = false;
      search_.asked_at.reset();  // at once again, with another scan
    } else if (verdict.is_believed) {
      search_.rival.reset();
      search_.alarm_step = std::clamp(2.0 * search_.alarm_step, kAskStep, kLargestAlarmStep);
      // Where the map explains nothing, or other places together are likelier, nothing is
      // confirmed.
      if (verdict.best.seen < kFits || verdict.probability < kLikely) return;
      inliers_.reset();  // no place fits better: what is seen now is normal here
      search_.confirmed = search_.alarm_from.has_value();
    }
    return;
  }
  const bool beaten = !verdict.is_believed && verdict.probability >= params_.lost_probability;
  if (search_.guided && answer.believed && !beaten)
    return;  // the filter goes on with what was told
  search_.guided = false;
  if (verdict.probability >= params_.found_probability && verdict.best.seen >= kFits) {
    trackAt(verdict.best.base * motion, result);
  } else if (verdict.best.seen >= kFits) {
    followPlaces(verdict.hypotheses, motion);
  }
}

/// Whether the pose is given up for a better place. Scans that fit neither each other nor the map
/// say that the robot was carried off, one answer is enough. Where they fit each other it is rather
/// the map that is wrong: the same place must be better again, half a metre on.
bool Localizer::isContradicted(const SearchAnswer& answer, const Verdict& verdict) {
  if (search_.carried) return true;
  const std::optional<Rival> before = search_.rival;
  const bool same =
      before && isSamePlace(before->place * between(before->base_in_odom, answer.base_in_odom),
                            verdict.best.base);
  if (!same) search_.rival = Rival{verdict.best.base, answer.base_in_odom};
  search_.confirmed = false;
  return same && hyselam::distance(before->base_in_odom, answer.base_in_odom) >= kAskStep;
}

void Localizer::trackAt(const Pose2& base_in_grid, LocalizationResult& result) {
  const std::uint64_t stream = hyselam::mix(
      params_.seed, kPlaceStream + static_cast<std::uint64_t>(observation_.scan.stamp * 1e3));
  inliers_.reset();
  search_.tracked_from = search_.way;
  search_.next_check = kFirstCheck;
  search_.suspicious_until = -1.0;
  search_.alarm_from.reset();
  search_.suspicious_for = 0.0;
  search_.confirmed = search_.strange = search_.low = search_.carried = false;
  search_.rival.reset();
  state_ = LocalizerState::kTracking;
  startLikelihoodFilter(
      gaussianParticles(base_in_grid, kPlaceStddev, params_.tracking_particles, stream),
      std::min(params_.tracking_particles, params_.hypothesis_particles),
      params_.likelihood.independent_beams);
  filter_.step({}, *likelihood_model_, observation_);
  LocalizationResult found = resultOf(estimatePose(filter_.particles()), result.effective_size);
  found.inlier_ratio = result.inlier_ratio;
  result = found;
}

/// Particles on all places, more on the better ones.
void Localizer::followPlaces(const std::vector<Place>& places, const Pose2& motion) {
  constexpr double kPerScore = 20.0;  // log odds
  Particles all;
  const std::size_t each = std::max<std::size_t>(
      1, params_.hypothesis_particles / std::max<std::size_t>(1, places.size()));
  all.resize(each * places.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    const std::uint64_t stream = hyselam::mix(
        params_.seed, kPlaceStream + p + static_cast<std::uint64_t>(observation_.scan.stamp * 1e3));
    const Particles some = gaussianParticles(places[p].base * motion, kPlaceStddev, each, stream);
    const auto weight =
        static_cast<float>(std::exp(kPerScore * (places[p].seen - places.front().seen)));
    for (std::size_t i = 0; i < each; ++i) all.set(p * each + i, some.pose(i), weight);
  }
  startHypotheses(std::move(all));
}

}  // namespace fsd_localization

// The localizer's decisions by the search of whole maps: what is believed, and when it is not any
// more.
#include <algorithm>
#include <cmath>

#include "fsd_localization/localizer.hpp"

namespace fsd_localization {

using hyselam::Pose2;

namespace {

// Where a number was chosen: docs/algorithms/localization.md, "Numbers of the alarms".
constexpr double kSupposedVariance = 1.0;  // [m^2], along each axis, at least
constexpr double kAskStep = 0.5;           // [m] between questions of a robot that is not found
constexpr double kAlarmLength = 2.0;       // [m] of scans at most that an alarm is about
constexpr double kFirstCheck = 2.0;        // [m] after a place was found, and then twice as far
constexpr double kCheckStep = 30.0;        // [m] at most between checks
constexpr double kCheckLength = 5.0;       // [m] of scans of a check
constexpr double kOneScan = 0.3;           // [m] a shorter submap is a scan: SubmapBuilder's step
constexpr double kUsual = 0.75;            // of the usual share of inliers: less is unusual
constexpr double kFits = 0.3;       // a place with a lower score does not explain what is seen
constexpr double kLikely = 0.5;     // probability from which on a search confirms a pose
constexpr double kHopeless = 0.01;  // probability of a pose beside a better place: as good as lost
constexpr double kImpossible = 1e-6;
constexpr double kThroughWalls = 0.1;   // share of the beams that go through what the map has
constexpr double kMapEvidence = 1.5;    // [m] of scans
constexpr double kAgreedWay = 2.0;      // [m] that filter and search agree before both are believed
constexpr double kDoubtPerMetre = 2.5;  // of it: times that of a found place, what may be left
constexpr Pose2 kPlaceStddev{0.1, 0.1, hyselam::radians(3.0)};
constexpr std::uint64_t kPlaceStream = 0x91ace5;

}  // namespace

void Localizer::forgetSearch() {
  search_.submap.reset();
  search_.short_term.clear();
  if (search_.background) search_.background->drop();
  search_.waits_from.reset();
  search_.verdict.reset();
  search_.judged_at.reset();
  search_.standing.reset();
  search_.odd_standing.reset();
  search_.elsewhere = false;
  search_.tracked.reset();
  search_.alarm.reset();
  search_.signs = {};
  search_.usual_match.reset();
  search_.score.reset();
  search_.rivals.reset();
  search_.followed.reset();
  search_.probation.reset();
  search_.guided = false;
}

/// What a tracked pose sees beside the map; nothing of where the robot may have been carried.
void Localizer::learnShortTerm(const Pose2& base_in_grid) {
  if (!params_.short_term_layer || state_ != LocalizerState::kTracking) return;
  if (search_.alarm.looksCarried() || search_.rivals.hasRival()) return;
  if (search_.tracked_from == search_.way) return;  // found just now: the pose is that of before
  const double range = params_.likelihood.max_range;
  search_.short_term.add(
      ShortTermLayer::endsOf(observation_.scan, *updated_odom_, range),
      likelihood_model_->areInliers(ShortTermLayer::endsOf(observation_.scan, base_in_grid, range),
                                    params_.inlier_distance),
      search_.way);
}

std::vector<hyselam::Point2> Localizer::shortTermPoints(const Pose2& base_in_map) const {
  std::vector<hyselam::Point2> points = search_.short_term.points();
  if (!updated_odom_) return {};
  const Pose2 odom_in_map = base_in_map * updated_odom_->inverse();
  for (hyselam::Point2& p : points) p = odom_in_map * p;
  return points;
}

/// Whether something about a standing robot is to be told: it begins to see what does not fit the
/// map, or ceases to, or a search has confirmed its pose since.
bool Localizer::watchStanding(bool stands, const hyselam::LaserScan& scan, const Pose2& delta) {
  if (!stands || !search_.tracked || state_ != LocalizerState::kTracking) {
    search_.standing.reset();
    search_.odd_standing.reset();
    search_.doubted_standing = false;
    return false;
  }
  const auto ratio =
      likelihood_model_->inlierRatio(scan, *search_.tracked * delta, params_.inlier_distance);
  // What fits less than usual is asked about: the update finds it odd.
  const double usual = kUsual * inliers_.usual();
  const bool changed = search_.odd_standing.add(scan.stamp, ratio, usual, usual);
  const bool asks = changed && (search_.odd_standing.isLow() || search_.elsewhere);
  if (asks && !search_.odd_standing.isLow()) search_.waits_from.reset();  // by a scan that fits
  const double fits = std::max(params_.lost_inlier_ratio, params_.found_inlier_ratio);
  if (!search_.standing.add(scan.stamp, ratio, params_.lost_inlier_ratio, fits)) {
    const bool confirmed = search_.doubted_standing && !isInDoubt();
    if (confirmed) search_.doubted_standing = false;
    return confirmed || asks;
  }
  if (search_.standing.isLow()) {
    search_.signs.very_low = search_.signs.low = search_.doubted_standing = true;
  } else {
    search_.waits_from.reset();  // asked again, by a scan that fits
  }
  return true;
}

/// Whether the pose explains the last metres worse than usual.
bool Localizer::fitsWorse(const PoseEstimate& estimate) {
  if (search_.score.isDue(search_.way) && !search_.submap.empty()) {
    const Submap submap = search_.submap.build(kAlarmLength, kTurnAsTravel);
    search_.score.look(search_.way,
                       search_.background->places().refine(submap, estimate.mean).seen);
  }
  return search_.score.isWorse();
}

/// While tracking: whether something speaks against the pose, and whether it is told as sure.
void Localizer::watchForAlarms(const PoseEstimate& estimate, LocalizationResult& result) {
  AlarmWatch::Signs signs = search_.signs;
  search_.signs = {};
  signs.odd = inliers_.isOdd(kUsual);
  signs.unusual = !inliers_.isUsual(kUsual);
  signs.very_low = signs.very_low || inliers_.isBelow(params_.lost_inlier_ratio, 0.0);
  signs.low = signs.low || inliers_.isBelow(params_.lost_inlier_ratio, params_.lost_relative_ratio);
  signs.worse = fitsWorse(estimate);
  if (search_.alarm.add(search_.way, signs)) {
    search_.background->drop();  // what was asked before says nothing about it
    search_.judged_at.reset();
    if (signs.odd || signs.low) {
      search_.waits_from.reset();  // asked at once
    } else {
      search_.waits_from = search_.way;  // what the map confirms can wait
    }
  }
  // Meanwhile nobody should rely on the pose; but the robot is not lost before another place is
  // better.
  if (isInDoubt()) result.converged = false;
  if (search_.odd_standing.isLow() && isInDoubt()) search_.doubted_standing = true;
}

bool Localizer::isInDoubt() const {
  return search_.alarm.isDoubtful() || search_.rivals.hasRival() ||
         search_.probation.isDoubtful() || search_.elsewhere;
}

void Localizer::updateBySearch(const PoseEstimate& estimate, double motion,
                               LocalizationResult& result) {
  const bool tracking = state_ == LocalizerState::kTracking;
  const bool was_sure = tracking && result.converged;
  if (!isSearching(state_)) {
    result.inlier_ratio =
        likelihood_model_->inlierRatio(observation_.scan, estimate.mean, params_.inlier_distance);
    inliers_.add(result.inlier_ratio, motion);
  }
  if (tracking) {
    watchForAlarms(estimate, result);
  } else if (search_.guided && result.converged &&
             inliers_.average() >= params_.found_inlier_ratio) {
    search_.guided = false;
    search_.tracked_from = search_.way;
    search_.next_check = kFirstCheck;
    startTracking();
  } else {
    result.converged = false;
  }
  takeAnswer(estimate, result);
  // Of one that stands, a doubt that this answer has removed need not be told.
  if (was_sure && search_.odd_standing.isLow() && state_ == LocalizerState::kTracking &&
      !isInDoubt()) {
    result.converged = true;
  }
  if (!result.converged) widen(result);
  result.misfits_standing =
      search_.standing.isLow() || (search_.odd_standing.isLow() && search_.elsewhere);
  search_.tracked = between(map_->geometry().origin, result.base_in_map);
  askSearch(estimate);
  if (search_.verdict) {
    result.place_probability = search_.verdict->probability;
    result.places = search_.verdict->best.seen < kFits
                        ? 0
                        : static_cast<int>(search_.verdict->hypotheses.size());
  }
}

/// The covariance of a pose that is not relied on. A place that is only supposed, the only one that
/// fits, does not look certain; nor does a tracked one in doubt, whose particles know of no other.
void Localizer::widen(LocalizationResult& result) const {
  if (state_ == LocalizerState::kTracking && search_.verdict && search_.judged_at) {
    const Pose2 motion = between(*search_.judged_at, *updated_odom_);
    const std::vector<Place>& places = search_.verdict->hypotheses;
    for (const Place& place : places) {
      const Pose2 base = map_->geometry().origin * place.base * motion;
      const Eigen::Vector3d off(base.x - result.base_in_map.x, base.y - result.base_in_map.y,
                                hyselam::normalizeAngle(base.theta - result.base_in_map.theta));
      result.covariance += off * off.transpose() / static_cast<double>(places.size());
    }
  }
  for (int i : {0, 1}) {
    result.covariance(i, i) = std::max(result.covariance(i, i), kSupposedVariance);
  }
}

/// What was seen before an alarm may belong to another place, if the scans say so.
double Localizer::lengthOfAlarm() const {
  if (!search_.alarm.isSharp()) return kCheckLength;
  return std::min(kAlarmLength, search_.alarm.length(search_.way).value_or(kAlarmLength));
}

/// Whether a place that was better than the tracked one must be so again by what was seen since it
/// was told: where each scan fits the map, only how they are joined speaks for it.
bool Localizer::needsOwnScans() const {
  return !search_.alarm.looksCarried() && !search_.alarm.isSharp();
}

/// While tracking: an alarm, a place that was better, or a place found lately.
bool Localizer::wantsSearch() {
  if (needsOwnScans() && search_.rivals.isTooEarly(search_.way)) return false;
  const double since = search_.waits_from ? search_.way - *search_.waits_from : kAskStep;
  const bool check = search_.way - search_.tracked_from >= search_.next_check;
  const bool again =
      search_.rivals.hasRival() || (search_.probation.isOpen() && since >= Probation::kStep) ||
      (search_.alarm.isOpen() && (!search_.waits_from || since >= search_.alarm.step()));
  if (check) search_.next_check += std::min(search_.next_check, kCheckStep);
  return check || again;
}

/// Asks when there is a reason to: not found yet; an alarm; a place found lately.
void Localizer::askSearch(const PoseEstimate& estimate) {
  if (search_.background->busy() || search_.submap.empty()) return;
  if (search_.waits_from && search_.way - *search_.waits_from < kAskStep) return;
  double length = SubmapBuilder::kMaxLength, turn_as_travel = 0.0;
  std::optional<Pose2> believed;
  if (state_ == LocalizerState::kTracking) {
    if (!wantsSearch()) return;
    length = kCheckLength;
    if (search_.alarm.isOpen()) {
      length = lengthOfAlarm();
      turn_as_travel = kTurnAsTravel;
    }
    if (search_.rivals.hasRival() && needsOwnScans()) {
      length = search_.rivals.ownScans(search_.way, length);
      turn_as_travel = kTurnAsTravel;
    }
    believed = estimate.mean;
  } else if (search_.guided) {
    believed = estimate.mean;
  }
  search_.asked_at = search_.way;
  search_.waits_from = search_.way;
  search_.background->ask(observation_.scan.stamp, *updated_odom_,
                          search_.submap.build(length, turn_as_travel), believed);
}

void Localizer::takeAnswer(const PoseEstimate& estimate, LocalizationResult& result) {
  const auto answer = search_.background->take(observation_.scan.stamp, wait_for_search_);
  if (!answer) return;
  search_.verdict = judge(*answer, params_.place_odds);
  search_.judged_at = answer->base_in_odom;
  if (search_.verdict) decide(*answer, *search_.verdict, estimate, result);
}

/// Whether another place is so much better that the tracked pose is as good as lost; where the
/// scans fit the map badly, also if several others are and nobody knows which. Where nothing but
/// the map speaks against the pose, it takes more scans or a greater difference: the map may be
/// wrong here.
bool Localizer::isBeaten(const SearchAnswer& answer, const Verdict& verdict) const {
  if (search_.alarm.looksCarried()) {
    return verdict.probability >= params_.lost_probability ||
           verdict.believed_probability < kHopeless;
  }
  const bool impossible = verdict.believed_probability < kImpossible;
  if (verdict.probability >= params_.lost_probability) {
    return impossible || lengthWithTurns(answer.length, answer.turned) >= kMapEvidence;
  }
  return impossible && search_.alarm.isSharp() && verdict.probability >= kLikely;
}

void Localizer::decide(const SearchAnswer& answer, const Verdict& verdict,
                       const PoseEstimate& estimate, LocalizationResult& result) {
  const Pose2 motion = between(answer.base_in_odom, *updated_odom_);
  const bool is_beaten = answer.believed && !verdict.best_is_believed && isBeaten(answer, verdict);
  const bool fits = verdict.best.seen >= kFits;
  if (state_ == LocalizerState::kTracking) {
    if (!answer.believed) return;  // asked before
    // By what had been seen when it was asked.
    search_.probation.answered(search_.asked_at, fits ? verdict.believed_probability : 0.0,
                               params_.found_probability);
    const bool is_better = fits && !verdict.best_is_believed &&
                           verdict.believed_probability < kHopeless &&
                           answer.blocked >= kThroughWalls;
    search_.elsewhere = is_better && (search_.elsewhere || search_.odd_standing.isLow());
    if (search_.elsewhere) {
      result.converged = false;
      search_.doubted_standing = true;
    }
    if (!is_beaten) {
      confirmPose(verdict);
      return;
    }
    // A single scan was odd, and those after it are not.
    if (lengthWithTurns(answer.length, answer.turned) < kOneScan &&
        inliers_.isUsual(params_.lost_relative_ratio)) {
      return;
    }
    result.converged = false;
    if (!isContradicted(answer, verdict)) return;
    state_ = LocalizerState::kLostSearch;
    search_.short_term.clear();
    search_.submap.keepLast(lengthOfAlarm(), kTurnAsTravel);
    if (fits && verdict.probability >= params_.found_probability) {  // it also says where it is
      trackAt(verdict.best.base * motion, result);
      return;
    }
    followPlaces(verdict.hypotheses, motion, estimate);
    search_.waits_from.reset();  // at once again, with another scan
    return;
  }
  if (search_.guided && answer.believed && !is_beaten)
    return;  // the filter goes on with what was told
  search_.guided = false;
  const Pose2 best = verdict.best.base * motion;
  search_.followed.compare(fits ? std::optional<Pose2>(best) : std::nullopt,
                           isSearching(state_) ? std::nullopt : std::optional(estimate.mean),
                           search_.way);
  if (!fits) return;
  if (verdict.probability >= params_.found_probability || isAgreed(verdict, estimate)) {
    trackAt(best, result);
  } else {
    followPlaces(verdict.hypotheses, motion, estimate);
  }
}

/// Whether the place that the search finds best, though not sure, has outlived all others in the
/// filter: it also knows what was seen before the scans of a search.
bool Localizer::isAgreed(const Verdict& verdict, const PoseEstimate& estimate) const {
  const double agreed = search_.followed.agreedFor(search_.way).value_or(0.0);
  const double doubt = kDoubtPerMetre * agreed * (1.0 - params_.found_probability);
  return agreed >= kAgreedWay && estimate.cluster_weight >= params_.found_probability &&
         verdict.probability >= std::max(kLikely, 1.0 - doubt) &&
         inliers_.average() >= params_.found_inlier_ratio;
}

/// A search has found no place that is so much better than the tracked one that it counts.
void Localizer::confirmPose(const Verdict& verdict) {
  search_.alarm.answered(!verdict.best_is_believed &&
                         verdict.probability >= params_.lost_probability);
  if (verdict.best_is_believed || verdict.believed_probability > 1.0 - params_.lost_probability) {
    search_.rivals.reset();
  }
  if (!verdict.best_is_believed) return;
  // Where the map explains nothing, or other places together are likelier, nothing is confirmed.
  if (verdict.best.seen < kFits || verdict.probability < kLikely) return;
  inliers_.accept();  // no place fits better: what is seen now is normal here
  search_.score.reset();
  search_.alarm.confirm();
}

/// Whether the pose is given up for a better place. Scans that fit neither each other nor the map
/// say that the robot was carried off, one answer is enough. Where they fit each other it is rather
/// the map that is wrong: the same place must be better again, half a metre on.
bool Localizer::isContradicted(const SearchAnswer& answer, const Verdict& verdict) {
  return search_.alarm.looksCarried() ||
         search_.rivals.isBetterAgain(verdict.best.base, answer.base_in_odom, search_.way);
}

void Localizer::trackAt(const Pose2& base_in_grid, LocalizationResult& result) {
  const std::uint64_t stream = hyselam::mix(
      params_.seed, kPlaceStream + static_cast<std::uint64_t>(observation_.scan.stamp * 1e3));
  inliers_.reset();
  search_.tracked_from = search_.way;
  search_.next_check = kFirstCheck;
  search_.probation.begin(search_.way);
  search_.alarm.reset();
  search_.signs = {};
  search_.score.reset();
  search_.rivals.reset();
  search_.elsewhere = false;
  search_.short_term.clear();
  search_.followed.reset();
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

/// Particles on all places, more on the better ones. If the filter's own place is among them, it
/// keeps what it has gathered, and only places are added that it has not followed.
void Localizer::followPlaces(const std::vector<Place>& places, const Pose2& motion,
                             const PoseEstimate& estimate) {
  constexpr double kPerScore = 20.0;  // log odds
  std::vector<Pose2> bases;
  for (const Place& p : places) bases.push_back(p.base * motion);
  const auto own = std::find_if(bases.begin(), bases.end(), [&](const Pose2& base) {
    return isSamePlace(base, estimate.mean) && search_.followed.has(base, *updated_odom_);
  });
  const bool keep = own != bases.end();
  if (!keep) search_.followed.reset();
  const std::vector<std::size_t> added = search_.followed.follow(bases, *updated_odom_);
  if (added.empty()) return;

  const std::size_t each = std::max<std::size_t>(1, params_.hypothesis_particles / places.size());
  Particles all;
  double score = places.front().seen, weight = 1.0;  // of one that others are compared with
  if (keep) {
    all = filter_.resampledCopy(each * (places.size() - added.size()), {});
    score = places[static_cast<std::size_t>(own - bases.begin())].seen;
    weight = estimate.cluster_weight * static_cast<double>(all.size()) / static_cast<double>(each);
  }
  const std::size_t kept = all.size();
  all.resize(kept + each * added.size());
  for (std::size_t a = 0; a < added.size(); ++a) {
    const std::size_t p = added[a];
    const std::uint64_t stream = hyselam::mix(
        params_.seed, kPlaceStream + p + static_cast<std::uint64_t>(observation_.scan.stamp * 1e3));
    const Particles some = gaussianParticles(bases[p], kPlaceStddev, each, stream);
    const auto w = static_cast<float>(weight * std::exp(kPerScore * (places[p].seen - score)));
    for (std::size_t i = 0; i < each; ++i) all.set(kept + a * each + i, some.pose(i), w);
  }
  startHypotheses(std::move(all));
}

}  // namespace fsd_localization

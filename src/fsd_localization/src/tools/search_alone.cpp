#include "search_alone.hpp"

#include <cmath>

namespace fsd_localization {

namespace {
constexpr double kAskStep = 0.5;  // [m]
constexpr double kFits = 0.3;     // of the score, as in the localizer
}  // namespace

SearchAlone::SearchAlone(const hyselam::OccupancyGrid& map, const LocalizerParams& params)
    : params_(params), origin_(map.geometry.origin), places_(map, params.map.thresholds) {}

std::optional<LocalizationResult> SearchAlone::update(const hyselam::LaserScan& scan,
                                                      const hyselam::Pose2& base_in_odom) {
  if (last_odom_) travelled_ += hyselam::distance(*last_odom_, base_in_odom);
  last_odom_ = base_in_odom;
  const auto step = odometry_.add(scan, base_in_odom);
  if (step.broken) submap_.reset();
  submap_.add(scan, step.pose);
  if (updated_) {
    const hyselam::Pose2 delta = between(*updated_, step.pose);
    if (std::hypot(delta.x, delta.y) < params_.update_min_d &&
        std::abs(delta.theta) < params_.update_min_a) {
      return std::nullopt;
    }
    if (base_) base_ = *base_ * delta;
  }
  updated_ = step.pose;
  if (!asked_ || hyselam::distance(*asked_, step.pose) >= kAskStep) search(step.pose);

  LocalizationResult result;
  result.stamp = scan.stamp;
  result.base_in_map = origin_ * base_.value_or(hyselam::Pose2{});
  result.converged = sure_;
  result.phase = sure_ ? Phase::kTracking : was_sure_ ? Phase::kLost : Phase::kGlobal;
  result.cluster_weight = base_ ? 1.0 : 0.0;
  result.travelled = travelled_;
  result.place_probability = probability_;
  return result;
}

void SearchAlone::search(const hyselam::Pose2& smooth) {
  asked_ = smooth;
  SearchAnswer answer;
  const Submap submap = submap_.build();
  answer.length = submap.length;
  answer.turned = submap.turned;
  answer.places = places_.search(submap);
  const auto verdict = judge(answer, params_.place_odds);
  if (!verdict) return;
  probability_ = verdict->probability;
  const bool same = base_ && isSamePlace(verdict->best.base, *base_);
  const bool told =
      verdict->probability >= params_.found_probability && verdict->best.seen >= kFits;
  if (!sure_ || same) base_ = verdict->best.base;
  if (sure_ && !same && verdict->probability >= params_.lost_probability) {
    base_ = verdict->best.base;
    sure_ = false;
  }
  sure_ = sure_ || told;
  was_sure_ = was_sure_ || sure_;
}

}  // namespace fsd_localization

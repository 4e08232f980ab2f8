#include "ngram_slam/semantic_segmenter.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/word.hpp"

namespace ngram_slam {
namespace {

double rise(const SemanticCut& cut, const std::optional<double>& neighbour) {
  return neighbour ? cut.level - *neighbour : 0.0;
}

/// A density that only turned has varied all the way; one that stood differs where it is above both
/// neighbours, as in a hall. Corridors stand below what they join.
double variationOf(const SemanticCut& cut) {
  const double before = rise(cut, cut.before), after = rise(cut, cut.after);
  if (!cut.stands) return std::max(std::abs(before), std::abs(after));
  if (!cut.before || !cut.after) return std::max(0.0, before + after);
  return std::max(0.0, std::min(before, after));
}

}  // namespace

void SemanticParams::validate() const {
  cut.validate();
  if (shortest_gap < 0)
    throw hyselam::ParameterError("shortest_gap", shortest_gap, ">= 0 [observations]");
  if (longest_bend < shortest_gap || longest_bend > 100000)
    throw hyselam::ParameterError("longest_bend", longest_bend,
                                  "in 'shortest_gap' .. 100000 [observations]");
  if (!(turning > 0.0)) throw hyselam::ParameterError("turning", turning, "positive [rad]");
}

SemanticSegmenter::SemanticSegmenter(const SemanticParams& params,
                                     std::shared_ptr<const SemanticClassifier> classifier)
    : params_(params), classifier_(std::move(classifier)), cutter_(params.cut) {
  params_.validate();
  if (!classifier_) classifier_ = std::make_shared<DecisionTree>();
}

std::vector<SemanticRegion> SemanticSegmenter::add(const Observation& o) {
  const auto require = [&](bool good, const char* what) {
    if (!good)
      throw hyselam::InputError("observation",
                                std::to_string(run_begin_ + seen_begin_ + seen_.size()), what);
  };
  require(o.soft >= 0.0 && o.soft <= 1.0, "the density is not in 0..1");
  require(o.frontiers >= 0 && o.frontiers <= 255, "the number of frontiers is not in 0..255");
  require(std::isfinite(o.base_in_odom.x) && std::isfinite(o.base_in_odom.y) &&
              std::isfinite(o.base_in_odom.theta),
          "the pose is not finite");
  double heading = o.base_in_odom.theta;
  if (!seen_.empty()) {
    const Seen& last = seen_.back();
    heading = last.heading + hyselam::normalizeAngle(heading - last.pose.theta);
  }
  seen_.push_back({static_cast<float>(o.soft), static_cast<std::uint8_t>(o.frontiers),
                   o.base_in_odom, heading});
  std::vector<SemanticRegion> out;
  for (const SemanticCut& cut : cutter_.add(o.soft)) take(cut, out);
  // What follows has become too long to be a gap within what is held.
  const auto end = seen_begin_ + static_cast<std::uint32_t>(seen_.size());
  if (held_ && !open_ &&
      end > cutter_.growingSince() +
                static_cast<std::uint32_t>(params_.longest_bend + params_.cut.smoothing + 1 +
                                           params_.cut.settled_for))
    tell(out);
  return out;
}

std::vector<SemanticRegion> SemanticSegmenter::finish() {
  std::vector<SemanticRegion> out;
  for (const SemanticCut& cut : cutter_.finish()) take(cut, out);
  tell(out);
  run_begin_ += seen_begin_ + static_cast<std::uint32_t>(seen_.size());
  seen_.clear();
  seen_begin_ = 0;
  return out;
}

double SemanticSegmenter::turnIn(std::uint32_t first, std::uint32_t last) const {
  double low = seen_[first - seen_begin_].heading, high = low;
  for (std::uint32_t i = first; i <= last; ++i) {
    low = std::min(low, seen_[i - seen_begin_].heading);
    high = std::max(high, seen_[i - seen_begin_].heading);
  }
  return high - low;
}

void SemanticSegmenter::take(const SemanticCut& cut, std::vector<SemanticRegion>& out) {
  if (held_ && open_) {
    held_->last = cut.last;
    held_->level = std::max(held_->level, cut.level);
    held_->after = cut.after;
    open_ = false;
    return;
  }
  const int length = static_cast<int>(cut.last - cut.first) + 1;
  const bool trough = cut.before && cut.after && *cut.before > cut.level && *cut.after > cut.level;
  const bool gap =
      trough && (length < params_.shortest_gap ||
                 (length <= params_.longest_bend && turnIn(cut.first, cut.last) > params_.turning));
  if (held_ && gap) {
    held_->last = cut.last;
    open_ = true;
    return;
  }
  tell(out);
  held_ = cut;
}

void SemanticSegmenter::tell(std::vector<SemanticRegion>& out) {
  if (!held_) return;
  SemanticRegion region;
  region.first = run_begin_ + held_->first;
  region.last = run_begin_ + held_->last;
  region.features = featuresOf(*held_);
  const SemanticVerdict verdict = classifier_->classify(region.features);
  region.semantic_class = verdict.semantic_class;
  region.confidence = verdict.confidence;
  out.push_back(region);
  const std::uint32_t done = held_->last + 1 - seen_begin_;
  // The newest observation stays: the next heading follows it.
  const auto drop = std::min<std::size_t>(done, seen_.size() - 1);
  seen_.erase(seen_.begin(), seen_.begin() + static_cast<std::ptrdiff_t>(drop));
  seen_begin_ += static_cast<std::uint32_t>(drop);
  held_.reset();
  open_ = false;
}

SemanticFeatures SemanticSegmenter::featuresOf(const SemanticCut& cut) const {
  SemanticFeatures f;
  const auto seen = [&](std::uint32_t i) -> const Seen& { return seen_[i - seen_begin_]; };
  f.length = static_cast<double>(cut.last - cut.first) + 1.0;
  f.level = cut.level;
  f.rise_before = rise(cut, cut.before);
  f.rise_after = rise(cut, cut.after);
  f.variation = variationOf(cut);
  f.density_min = f.density_max = seen(cut.first).soft;
  for (std::uint32_t i = cut.first; i <= cut.last; ++i) {
    const Seen& s = seen(i);
    f.density_min = std::min(f.density_min, static_cast<double>(s.soft));
    f.density_max = std::max(f.density_max, static_cast<double>(s.soft));
    f.few_frontiers += s.frontiers <= 1;
    f.many_frontiers += s.frontiers >= 3;
  }
  // Where one region passes into the next, frontiers come and go.
  const std::uint32_t quarter = (cut.last - cut.first + 1) / 4;
  for (std::uint32_t i = cut.first + quarter; i <= cut.last - quarter; ++i)
    f.frontiers += seen(i).frontiers;
  f.frontiers /= f.length - 2.0 * quarter;
  f.few_frontiers /= f.length;
  f.many_frontiers /= f.length;
  f.turn = turnIn(cut.first, cut.last);
  f.angle = std::abs(angleVariation(seen(cut.first).pose,
                                    seen(cut.first + (cut.last - cut.first) / 2).pose,
                                    seen(cut.last).pose));
  f.stands = cut.stands ? 1.0 : 0.0;
  return f;
}

}  // namespace ngram_slam

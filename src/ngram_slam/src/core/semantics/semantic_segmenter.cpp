#include "ngram_slam/semantics/semantic_segmenter.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
void SemanticParams::validate() const {
  cut.validate();
  if (shortest_gap < 0)
    throw hyselam::ParameterError("shortest_gap", shortest_gap, ">= 0 [observations]");
  if (longest_bend < shortest_gap || longest_bend > 100000)
    throw hyselam::ParameterError("longest_bend", longest_bend,
                                  "in 'shortest_gap' .. 100000 [observations]");
  if (shortest_stretch < 0 || shortest_stretch > 100000)
    throw hyselam::ParameterError("shortest_stretch", shortest_stretch,
                                  "in 0 .. 100000 [observations]");
  if (widest_rim < 0 || widest_rim > 100000)
    throw hyselam::ParameterError("widest_rim", widest_rim, "in 0 .. 100000 [observations]");
  if (!(bend > 0.0)) throw hyselam::ParameterError("bend", bend, "positive [rad]");
  if (!(turning > 0.0)) throw hyselam::ParameterError("turning", turning, "positive [rad]");
}

SemanticSegmenter::SemanticSegmenter(const SemanticParams& params,
                                     std::shared_ptr<const SemanticClassifier> classifier)
    : params_(params), classifier_(std::move(classifier)), cutter_(params.cut) {
  params_.validate();
  if (!classifier_) classifier_ = std::make_shared<DecisionTree>();
}

std::vector<SemanticRegion> SemanticSegmenter::add(const DensityObservation& o) {
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
  if (held_ && !open_ && cutter_.grown() > static_cast<std::uint32_t>(params_.longest_bend))
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
  for (const SemanticCut& part : divided(*held_)) {
    SemanticRegion region;
    region.first = run_begin_ + part.first;
    region.last = run_begin_ + part.last;
    region.features = featuresOf(part);
    const SemanticVerdict verdict = classifier_->classify(region.features);
    region.semantic_class = verdict.semantic_class;
    region.confidence = verdict.confidence;
    out.push_back(region);
  }
  const std::uint32_t done = held_->last + 1 - seen_begin_;
  // The newest observation stays: the next heading follows it.
  const auto drop = std::min<std::size_t>(done, seen_.size() - 1);
  seen_.erase(seen_.begin(), seen_.begin() + static_cast<std::ptrdiff_t>(drop));
  seen_begin_ += static_cast<std::uint32_t>(drop);
  held_.reset();
  open_ = false;
}

std::vector<SemanticRegion> semanticRegions(const ObservationStore& observations,
                                            const SemanticParams& params) {
  SemanticSegmenter segmenter(params);
  std::vector<SemanticRegion> all;
  const auto take = [&](const std::vector<SemanticRegion>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  for (std::uint32_t run = 0; run < observations.runs(); ++run) {
    for (std::uint32_t i = observations.runBegin(run); i < observations.runEnd(run); ++i)
      take(segmenter.add(observations[i]));
    take(segmenter.finish());
  }
  return all;
}

}  // namespace ngram_slam

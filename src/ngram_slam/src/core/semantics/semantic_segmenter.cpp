#include "ngram_slam/semantics/semantic_segmenter.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
void SemanticParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.group("", cut);
  visit("min_gap", min_gap, Range::between(0, 100000), "observations",
        "shorter troughs between two higher regions join them to one");
  visit("max_bend", max_bend, Range::between(0, 100000), "observations",
        "so do longer ones, up to this, in which the robot turns by more than 'min_turn'");
  visit("min_turn", min_turn, Range::above(0.0), "rad", "see max_bend");
  visit("min_frontier_run", min_frontier_run, Range::between(0, 100000), "observations",
        "with three frontiers or more, or with fewer, that divides a region; 0: none does");
  visit("max_rim", max_rim, Range::between(0, 100000), "observations",
        "fewer frontiers at the rim of a region divide it if longer than this");
  visit("bend_angle", bend_angle, Range::above(0.0), "rad",
        "a bend by more, in steady density, is a region of its own; infinite: none is");
}

void SemanticParams::validate() const {
  hyselam::checkParameters(*this);
  cut.validate();
  if (max_bend < min_gap) {
    throw hyselam::ParameterError("max_bend", max_bend, "at least 'min_gap'");
  }
}

SemanticSegmenter::SemanticSegmenter(const SemanticParams& params,
                                     std::shared_ptr<const SemanticClassifier> classifier)
    : params_(params), classifier_(std::move(classifier)), cutter_(params.cut) {
  params_.validate();
  if (!classifier_) classifier_ = std::make_shared<DecisionTree>();
}

std::vector<SemanticRegion> SemanticSegmenter::add(const DensityObservation& o) {
  const auto require = [&](bool good, const char* what) {
    if (!good) {
      throw hyselam::InputError("observation",
                                std::to_string(run_begin_ + seen_begin_ + seen_.size()), what);
    }
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
  for (const SemanticCut& cut : cutter_.add(o.soft)) addCut(cut, out);
  // What follows has become too long to be a gap within what is held.
  if (pending_ && !open_ && cutter_.minLength() > static_cast<std::uint32_t>(params_.max_bend)) {
    closeRegion(out);
  }
  return out;
}

std::vector<SemanticRegion> SemanticSegmenter::finish() {
  std::vector<SemanticRegion> out;
  for (const SemanticCut& cut : cutter_.finish()) addCut(cut, out);
  closeRegion(out);
  run_begin_ += seen_begin_ + static_cast<std::uint32_t>(seen_.size());
  seen_.clear();
  seen_begin_ = 0;
  return out;
}

void SemanticSegmenter::addCut(const SemanticCut& cut, std::vector<SemanticRegion>& out) {
  if (pending_ && open_) {
    pending_->last = cut.last;
    pending_->level = std::max(pending_->level, cut.level);
    pending_->after = cut.after;
    open_ = false;
    return;
  }
  const int length = static_cast<int>(cut.last - cut.first) + 1;
  const bool trough = cut.before && cut.after && *cut.before > cut.level && *cut.after > cut.level;
  const bool gap =
      trough && (length < params_.min_gap ||
                 (length <= params_.max_bend && turnIn(cut.first, cut.last) > params_.min_turn));
  if (pending_ && gap) {
    pending_->last = cut.last;
    open_ = true;
    return;
  }
  closeRegion(out);
  pending_ = cut;
}

void SemanticSegmenter::closeRegion(std::vector<SemanticRegion>& out) {
  if (!pending_) return;
  for (const SemanticCut& part : divideAtFrontiers(*pending_)) {
    SemanticRegion region;
    region.first = run_begin_ + part.first;
    region.last = run_begin_ + part.last;
    region.features = featuresOf(part);
    const SemanticPrediction prediction = classifier_->classify(region.features);
    region.semantic_class = prediction.semantic_class;
    region.confidence = prediction.confidence;
    out.push_back(region);
  }
  const std::uint32_t done = pending_->last + 1 - seen_begin_;
  // The newest observation stays: the next heading follows it.
  const auto drop = std::min<std::size_t>(done, seen_.size() - 1);
  seen_.erase(seen_.begin(), seen_.begin() + static_cast<std::ptrdiff_t>(drop));
  seen_begin_ += static_cast<std::uint32_t>(drop);
  pending_.reset();
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
    for (std::uint32_t i = observations.runBegin(run); i < observations.runEnd(run); ++i) {
      take(segmenter.add(observations[i]));
    }
    take(segmenter.finish());
  }
  return all;
}

}  // namespace ngram_slam

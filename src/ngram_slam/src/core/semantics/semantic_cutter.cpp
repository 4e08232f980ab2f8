#include "ngram_slam/semantics/semantic_cutter.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

void SemanticCutParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("smoothing", smoothing, Range::between(0, 100), "observations",
        "on each side in the mean filter of densities");
  visit("change_threshold", change_threshold, Range::aboveUpTo(0.0, 1.0), "",
        "the density varies once it is this far from where it was steady or turned");
  visit("steady_tolerance", steady_tolerance, Range::aboveUpTo(0.0, 1.0), "",
        "it is steady once it keeps within this");
  visit("steady_length", steady_length, Range::between(2, 100000), "observations",
        "for which it must keep within 'steady_tolerance'");
  visit("border_share", border_share, Range::inside(0.0, 1.0), "",
        "share of the rise from the lower level to the higher one at the border of two regions");
}

void SemanticCutParams::validate() const {
  hyselam::checkParameters(*this);
  if (steady_tolerance > change_threshold) {
    throw hyselam::ParameterError("steady_tolerance", steady_tolerance,
                                  "at most 'change_threshold'");
  }
}

SemanticCutter::SemanticCutter(const SemanticCutParams& params) : params_(params) {
  params_.validate();
}

std::vector<SemanticCut> SemanticCutter::add(double density) {
  std::vector<SemanticCut> out;
  const auto reach = static_cast<std::uint32_t>(params_.smoothing);
  raw_.push_back(density);
  ++raw_end_;
  if (raw_.size() > 2 * reach + 1) raw_.pop_front();
  if (raw_end_ > reach) {
    double sum = 0.0;
    for (double d : raw_) sum += d;
    addSmoothed(sum / static_cast<double>(raw_.size()), out);
  }
  return out;
}

std::vector<SemanticCut> SemanticCutter::finish() {
  std::vector<SemanticCut> out;
  // The windows of the last observations are shorter.
  while (next_ < raw_end_) {
    const std::uint32_t begin = raw_end_ - static_cast<std::uint32_t>(raw_.size());
    const auto reach = static_cast<std::uint32_t>(params_.smoothing);
    if (next_ > reach && begin < next_ - reach) raw_.pop_front();
    double sum = 0.0;
    for (double d : raw_) sum += d;
    addSmoothed(sum / static_cast<double>(raw_.size()), out);
  }
  if (next_ > 0) {
    if (!steady_) addLevel(at(extreme_), extreme_, false, out);
    growing_.last = next_ - 1;
    out.push_back(growing_);
  }
  *this = SemanticCutter(params_);
  return out;
}

/// A new level from observation `begin` on: the border to the one before, and that one's cut.
void SemanticCutter::addLevel(double level, std::uint32_t begin, bool steady,
                              std::vector<SemanticCut>& out) {
  const double share = level > growing_.level ? params_.border_share : 1.0 - params_.border_share;
  const double way = share * std::abs(level - growing_.level);
  std::uint32_t border = since_;
  while (border < begin && std::abs(at(border) - growing_.level) < way) ++border;
  growing_.last = border - 1;
  growing_.after = level;
  out.push_back(growing_);
  const double before = growing_.level;
  growing_ = {border, 0, level, steady, before, std::nullopt};
}

void SemanticCutter::addSmoothed(double x, std::vector<SemanticCut>& out) {
  const std::uint32_t i = next_++;
  if (i == 0) {
    growing_ = {0, 0, x, true, std::nullopt, std::nullopt};
    steady_ = true;
    sum_ = x;
    count_ = 1;
    return;
  }
  if (steady_) {
    if (std::abs(x - growing_.level) <= params_.change_threshold) {
      sum_ += x;
      growing_.level = sum_ / ++count_;
      return;
    }
    steady_ = false;
    direction_ = x > growing_.level ? 1 : -1;
    moved_.assign(1, x);
    since_ = extreme_ = i;
    return;
  }
  moved_.push_back(x);
  if (direction_ * (x - at(extreme_)) > 0.0) {
    extreme_ = i;
  } else if (direction_ * (at(extreme_) - x) > params_.change_threshold) {
    addLevel(at(extreme_), extreme_, false, out);
    moved_.erase(moved_.begin(), moved_.begin() + (extreme_ + 1 - since_));
    since_ = extreme_ + 1;
    direction_ = -direction_;
    // Whatever lay between is nearer to the extreme than `change_threshold`.
    extreme_ = i;
  }
  const auto n = static_cast<std::size_t>(params_.steady_length);
  if (moved_.size() < n) return;
  const auto window = moved_.end() - static_cast<std::ptrdiff_t>(n);
  const auto range = std::minmax_element(window, moved_.end());
  if (*range.second - *range.first >= params_.steady_tolerance) return;
  sum_ = 0.0;
  for (auto w = window; w != moved_.end(); ++w) sum_ += *w;
  count_ = static_cast<std::uint32_t>(n);
  addLevel(sum_ / count_, i + 1 - count_, true, out);
  steady_ = true;
  moved_.clear();
}

}  // namespace ngram_slam

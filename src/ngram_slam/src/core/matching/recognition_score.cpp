#include "ngram_slam/matching/recognition_score.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
namespace {

// Observations in one square that follow each other.
struct Interval {
  std::uint32_t first, last;
};

}  // namespace

void ScoreParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("distance", distance, Range::above(0.0), "m", "of a true pair at most");
  visit("heading", heading, Range::aboveUpTo(0.0, 0.5 * hyselam::kPi), "rad",
        "difference of the headings of a true pair at most");
  visit("separation", separation, Range::atLeast(0), "observations",
        "between the two of a pair in one run at least");
  visit("pass_gap", pass_gap, Range::atLeast(1), "observations", "between two passes at least");
}

void ScoreParams::validate() const {
  hyselam::checkParameters(*this);
}

RecognitionTruth::RecognitionTruth(std::vector<std::optional<hyselam::Pose2>> reference,
                                   std::vector<std::uint32_t> run, const ScoreParams& params)
    : reference_(std::move(reference)), run_(std::move(run)), params_(params) {
  params.validate();
  if (run_.size() != reference_.size()) {
    throw hyselam::ParameterError(
        "runs", run_.size(), "as many as reference poses, " + std::to_string(reference_.size()));
  }
  any_.assign(run_.size(), 0);
  begin_.assign(1, 0);
  findPasses();
}

bool RecognitionTruth::counts(std::uint32_t newer, std::uint32_t older) const {
  return reference_[newer] && reference_[older] &&
         (run_[newer] != run_[older] || newer - older >= params_.separation);
}
bool RecognitionTruth::near(std::uint32_t a, std::uint32_t b) const {
  const double dx = reference_[a]->x - reference_[b]->x, dy = reference_[a]->y - reference_[b]->y;
  return dx * dx + dy * dy <= params_.distance * params_.distance;
}
bool RecognitionTruth::headingsFit(std::uint32_t a, std::uint32_t b, Direction direction) const {
  const double turn =
      std::abs(hyselam::normalizeAngle(reference_[a]->theta - reference_[b]->theta));
  return direction == Direction::kSame ? turn <= params_.heading
                                       : turn >= hyselam::kPi - params_.heading;
}

std::optional<bool> RecognitionTruth::isTrue(std::uint32_t newer, std::uint32_t older,
                                             Direction direction) const {
  if (newer < older) std::swap(newer, older);
  if (!counts(newer, older)) return std::nullopt;
  return near(newer, older) && headingsFit(newer, older, direction);
}

bool RecognitionTruth::revisit(std::uint32_t i) const {
  return begin_[i] < begin_[i + 1] && passes_[begin_[i]].direction == Direction::kSame;
}

void RecognitionTruth::findPasses() {
  // Squares with the distance as side: the neighbours of a square hold all that is near.
  std::unordered_map<std::uint64_t, std::vector<Interval>> squares;
  const auto square = [&](const hyselam::Pose2& p, int dx, int dy) {
    const auto i = static_cast<std::int32_t>(std::floor(p.x / params_.distance)) + dx;
    const auto k = static_cast<std::int32_t>(std::floor(p.y / params_.distance)) + dy;
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32 |
           static_cast<std::uint32_t>(k);
  };
  std::vector<Pass> found[2];
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (reference_[i]) {
      const hyselam::Pose2& at = *reference_[i];
      for (auto& passes : found) passes.clear();
      for (int d = 0; d < 9; ++d) {
        const auto here = squares.find(square(at, d / 3 - 1, d % 3 - 1));
        if (here == squares.end()) continue;
        for (const Interval& interval : here->second) {
          for (std::uint32_t older = interval.first; older <= interval.last; ++older) {
            if (!counts(i, older) || !near(i, older)) continue;
            any_[i] = 1;
            for (const Direction direction : {Direction::kSame, Direction::kReverse}) {
              if (!headingsFit(i, older, direction)) continue;
              auto& passes = found[direction == Direction::kReverse];
              if (!passes.empty() && passes.back().last + 1 == older &&
                  run_[passes.back().last] == run_[older]) {
                passes.back().last = older;
              } else {
                passes.push_back({older, older, direction});
              }
            }
          }
        }
      }
      for (auto& passes : found) {
        std::sort(passes.begin(), passes.end(),
                  [](const Pass& a, const Pass& b) { return a.first < b.first; });
        bool joined = false;
        for (const Pass& pass : passes) {
          joined = joined && run_[pass.first] == run_[passes_.back().last] &&
                   pass.first - passes_.back().last < params_.pass_gap;
          if (joined) {
            passes_.back().last = std::max(passes_.back().last, pass.last);
          } else {
            passes_.push_back(pass);
          }
          joined = true;
        }
      }
      auto& intervals = squares[square(at, 0, 0)];
      if (!intervals.empty() && intervals.back().last + 1 == i) {
        intervals.back().last = i;
      } else {
        intervals.push_back({i, i});
      }
    }
    begin_.push_back(passes_.size());
  }
}

RecognitionScore::RecognitionScore(std::shared_ptr<const RecognitionTruth> truth)
    : truth_(std::move(truth)) {
  pairs_.assign(truth_->size(), 0);
  true_pairs_ = pairs_;
  recognized_.assign(truth_->size(), 0);
  recognized_any_ = recognized_;
  pass_.assign(truth_->passes().size(), 0);
}

std::optional<bool> RecognitionScore::add(std::uint32_t newer, std::uint32_t older,
                                          Direction direction) {
  if (newer < older) std::swap(newer, older);
  const std::optional<bool> right = truth_->isTrue(newer, older, direction);
  if (!right) return std::nullopt;
  const bool reverse = direction == Direction::kReverse;
  // Observations are fewer than 2^31: the topmost bit is free.
  if (!seen_
           .insert(static_cast<std::uint64_t>(reverse) << 63 |
                   static_cast<std::uint64_t>(newer) << 32 | older)
           .second) {
    return right;
  }
  ++pairs_[newer];
  if (!*right) return right;
  ++true_pairs_[newer];
  recognized_any_[newer] = 1;
  if (!reverse) recognized_[newer] = 1;
  const auto begin =
      truth_->passes().begin() + static_cast<std::ptrdiff_t>(truth_->passesBegin(newer));
  const auto end = truth_->passes().begin() + static_cast<std::ptrdiff_t>(truth_->passesEnd(newer));
  const auto at = std::find_if(begin, end, [&](const RecognitionTruth::Pass& p) {
    return p.direction == direction && p.first <= older && older <= p.last;
  });
  if (at != end) pass_[static_cast<std::size_t>(at - truth_->passes().begin())] = 1;
  return right;
}

RecognitionFigures RecognitionScore::figures(std::uint32_t until) const {
  RecognitionFigures f;
  until = std::min(until, truth_->size());
  for (std::uint32_t i = 0; i < until; ++i) {
    f.pairs += pairs_[i];
    f.true_pairs += true_pairs_[i];
    if (truth_->revisit(i)) {
      ++f.revisits;
      f.recognized += recognized_[i] != 0;
    }
    if (truth_->revisitAnyDirection(i)) {
      ++f.revisits_any;
      f.recognized_any += recognized_any_[i] != 0;
    }
    for (std::size_t k = truth_->passesBegin(i); k < truth_->passesEnd(i); ++k) {
      ++f.passes_any;
      f.recognized_passes_any += pass_[k] != 0;
      if (truth_->passes()[k].direction == Direction::kReverse) continue;
      ++f.passes;
      f.recognized_passes += pass_[k] != 0;
    }
  }
  return f;
}

}  // namespace ngram_slam

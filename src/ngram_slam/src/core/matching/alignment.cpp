#include "ngram_slam/matching/alignment.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

void AlignmentParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("max_shift", max_shift, Range::atLeast(1), "observations", "shifts below it are tried");
  visit("min_overlap", min_overlap, Range::aboveUpTo(0.0, 1.0), "",
        "share of the observations that must have a partner");
}

void AlignmentParams::validate() const {
  hyselam::checkParameters(*this);
}

std::optional<Alignment> align(const ObservationStore& observations, std::uint32_t s1,
                               std::uint32_t s2, std::uint32_t n, const AlignmentParams& params,
                               Direction direction) {
  params.validate();
  const std::uint32_t run1 = observations.runOf(s1), run2 = observations.runOf(s2);
  const auto begin1 = static_cast<std::int64_t>(observations.runBegin(run1));
  const auto end1 = static_cast<std::int64_t>(observations.runEnd(run1));
  // Older observations s2, s2 + way, ...: as many as their run has.
  const std::int64_t way = direction == Direction::kSame ? 1 : -1;
  const std::int64_t left = way > 0 ? std::int64_t{observations.runEnd(run2)} - s2
                                    : std::int64_t{s2} - observations.runBegin(run2) + 1;
  const std::int64_t count = std::min<std::int64_t>(n, left);
  std::optional<Alignment> best;
  double least = 0.0;
  for (int k = 0; k < 2 * params.max_shift - 1; ++k) {
    const int shift = k % 2 == 0 ? k / 2 : -(k + 1) / 2;  // 0, -1, 1, -2, 2, ...
    const std::int64_t first = std::int64_t{s1} + shift;  // beside s2
    const std::int64_t from = std::max<std::int64_t>(0, begin1 - first);
    const std::int64_t to = std::min(count, end1 - first);
    const std::int64_t terms = to - from;
    if (terms < 1 || static_cast<double>(terms) < params.min_overlap * n) continue;
    double sum = 0.0;
    for (std::int64_t i = from; i < to; ++i) {
      const double difference =
          observations.density(static_cast<std::uint32_t>(first + i), params.density) -
          observations.density(static_cast<std::uint32_t>(s2 + way * i), params.density);
      sum += difference * difference;
    }
    const double mean = sum / static_cast<double>(terms);
    if (best && mean >= least) continue;
    least = mean;
    best = Alignment{shift, std::sqrt(mean), static_cast<std::uint32_t>(terms)};
  }
  return best;
}

std::vector<ObservationPair> alignedObservations(const WordLattice& text,
                                                 const ObservationStore& observations,
                                                 const std::vector<WordPair>& ngram, int step,
                                                 const AlignmentParams& params,
                                                 Direction direction) {
  if (step < 1) throw hyselam::ParameterError("step", step, ">= 1 [observations]");
  std::vector<ObservationPair> pairs;
  for (const WordPair& words : ngram) {
    const std::uint32_t s1 = text.observationBegin(words.newer);
    const std::uint32_t begin2 = text.observationBegin(words.older);
    const std::uint32_t end2 = text.observationEnd(words.older);
    const bool same = direction == Direction::kSame;
    const std::uint32_t s2 = same ? begin2 : end2 - 1;
    const std::uint32_t n = std::min(text.observationEnd(words.newer) - s1, end2 - begin2);
    const auto alignment = align(observations, s1, s2, n, params, direction);
    if (!alignment) continue;
    const std::uint32_t run = observations.runOf(s1);
    for (std::uint32_t i = 0; i < n; i += static_cast<std::uint32_t>(step)) {
      const std::int64_t newer = std::int64_t{s1} + i + alignment->shift;
      if (newer < observations.runBegin(run) || newer >= observations.runEnd(run)) continue;
      pairs.push_back({static_cast<std::uint32_t>(newer), same ? s2 + i : s2 - i, alignment->rms});
    }
  }
  return pairs;
}

}  // namespace ngram_slam

#include "ngram_slam/matching/shared_matches.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/matching/ngram.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kMaxWords = 64;  // older ones were the end of a match before
constexpr double kWorstFit = -2.0;     // of one cell
constexpr double kSlip = 0.15;         // what a step of one cell beside two costs

std::size_t indexOf(Direction direction) {
  return direction == Direction::kReverse ? 1 : 0;
}
/// The direction from a to c, if those from a to b and from b to c are known.
Direction composed(Direction a, Direction b) {
  return a == b ? Direction::kSame : Direction::kReverse;
}
constexpr std::array kDirections{Direction::kSame, Direction::kReverse};

std::uint64_t keyOf(std::uint32_t newer, std::uint32_t older) {
  return static_cast<std::uint64_t>(newer) << 32 | older;
}
/// Of matches or links.
constexpr auto kSurestFirst = [](const auto& a, const auto& b) {
  return std::tie(b.probability, a.newer, a.older, a.direction) <
         std::tie(a.probability, b.newer, b.older, b.direction);
};
/// At most 6.9, for a link that is sure.
float weightOf(float probability) {
  return -std::log(1.001f - probability);
}

}  // namespace

void SharedMatchesParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("cell", cell, Range::between(1, 1000), "observations", "in a row that are one unit");
  visit("min_probability", min_probability, Range::between(0.0, 1.0), "",
        "of matches that are used");
  visit("density_scale", density_scale, Range::above(0.0), "",
        "a match goes on beyond its words while densities differ by less");
  visit("angle_scale", angle_scale, Range::above(0.0), "rad",
        "a match goes on beyond its words while turns differ by less");
  visit("max_drop", max_drop, Range::atLeast(0.0), "cells",
        "that do not fit, after which a match ends");
  visit("prior", prior, Range::above(0.0), "", "weight of matches that nobody shares");
  visit("min_similarity", min_similarity, Range::above(0.0), "", "of pairs that are told");
  visit("separation", separation, Range::atLeast(0), "observations",
        "between the two of a pair at least");
}

void SharedMatchesParams::validate() const {
  hyselam::checkParameters(*this);
}

SharedMatches::SharedMatches(const NgramRecognizer& recognizer, const SharedMatchesParams& params)
    : recognizer_(recognizer), params_((params.validate(), params)) {
  const ObservationStore& observations = recognizer.observations();
  const WordDensity which = recognizer.params().word_density;
  const auto step = static_cast<std::uint32_t>(params_.cell);
  cell_of_.reserve(observations.size());
  for (std::uint32_t run = 0; run < observations.runs(); ++run) {
    const std::uint32_t first = observations.runBegin(run), end = observations.runEnd(run);
    for (std::uint32_t begin = first; begin < end; begin += step) {
      const std::uint32_t after = std::min(end, begin + step);
      double sum = 0.0;
      for (std::uint32_t i = begin; i < after; ++i) {
        sum += observations.density(i, which);
        cell_of_.push_back(cells());
      }
      const std::uint32_t middle = begin + step / 2;
      const std::uint32_t from = middle - std::min(middle - first, step);
      const std::uint32_t to = std::min(end - 1, middle + step);
      begin_.push_back(begin);
      run_.push_back(run);
      density_.push_back(static_cast<float>(sum / (after - begin)));
      turn_.push_back(static_cast<float>(
          hyselam::normalizeAngle(observations.pose(to).theta - observations.pose(from).theta)));
    }
  }
}

bool SharedMatches::joined(std::int64_t from, std::int64_t to) const {
  return to >= 0 && to < cells() &&
         run_[static_cast<std::size_t>(from)] == run_[static_cast<std::size_t>(to)];
}

bool SharedMatches::apart(std::int64_t a, std::int64_t b) const {
  return std::abs(a - b) * params_.cell >= static_cast<std::int64_t>(params_.separation);
}

/// 1 for cells that are equal, below 0 for those that differ by more than the scales.
double SharedMatches::fit(Cell newer, Cell older, Direction direction) const {
  const float older_turn = direction == Direction::kSame ? turn_[older] : -turn_[older];
  const double density = (density_[newer] - density_[older]) / params_.density_scale;
  const double turn = (turn_[newer] - older_turn) / params_.angle_scale;
  return std::max(kWorstFit, 1.0 - density * density - turn * turn);
}

/// What matches lay over each other, with the probability of the surest one.
SharedMatches::Links SharedMatches::linksOf(std::vector<NgramMatch> matches) const {
  std::sort(matches.begin(), matches.end(), kSurestFirst);
  AlignmentParams alignment;
  alignment.density = recognizer_.params().word_density;
  std::array<std::unordered_set<std::uint64_t>, 2> done;  // pairs of words
  Links links;
  for (const NgramMatch& match : matches) {
    if (match.probability < params_.min_probability) break;
    const std::size_t d = indexOf(match.direction);
    for (const WordPair& words :
         longestNgram(recognizer_.text(), recognizer_.params().matcher.tolerance,
                      {match.newer, match.older}, match.levels, kMaxWords, match.direction)) {
      if (!done[d].insert(keyOf(words.newer, words.older)).second) continue;
      for (const ObservationPair& pair :
           alignedObservations(recognizer_.text(), recognizer_.observations(), {words}, 1,
                               alignment, match.direction)) {
        const Cell a = cell_of_[pair.newer], b = cell_of_[pair.older];
        if (apart(a, b)) {
          links[d].emplace(keyOf(std::max(a, b), std::min(a, b)),
                           static_cast<float>(match.probability));
        }
      }
    }
  }
  return links;
}

/// Carries a link on along the way of the newer cell, ahead or back, to where it fitted best.
void SharedMatches::extend(const Link& seed, int way, Links* links) const {
  static constexpr std::array<std::pair<int, int>, 3> kSteps{{{1, 1}, {1, 2}, {2, 1}}};
  auto& known = (*links)[indexOf(seed.direction)];
  const int older_way = seed.direction == Direction::kSame ? way : -way;
  std::int64_t a = seed.newer, b = seed.older;
  double sum = 0.0, most = 0.0;
  std::vector<std::uint64_t> path;
  std::size_t kept = 0;
  while (true) {
    double best = kWorstFit - 1.0;
    std::pair<std::int64_t, std::int64_t> next{-1, -1};
    for (const auto& [of_a, of_b] : kSteps) {
      const std::int64_t to_a = a + way * of_a, to_b = b + older_way * of_b;
      if (!joined(a, to_a) || !joined(b, to_b) || !apart(to_a, to_b)) continue;
      const double value = fit(static_cast<Cell>(to_a), static_cast<Cell>(to_b), seed.direction) -
                           (of_a == of_b ? 0.0 : kSlip);
      if (value > best) {
        best = value;
        next = {to_a, to_b};
      }
    }
    if (next.first < 0) break;
    std::tie(a, b) = next;
    sum += best;
    path.push_back(keyOf(static_cast<Cell>(std::max(a, b)), static_cast<Cell>(std::min(a, b))));
    if (sum > most) {
      most = sum;
      kept = path.size();
    } else if (sum < most - params_.max_drop) {
      break;
    }
    const auto at = known.find(path.back());  // a surer match has been here
    if (at != known.end() && at->second >= seed.probability && sum >= most) break;
  }
  for (std::size_t i = 0; i < kept; ++i) {
    float& probability = known[path[i]];
    probability = std::max(probability, seed.probability);
  }
}

SharedMatches::Links SharedMatches::extended(const Links& links) const {
  std::vector<Link> seeds;
  for (const Direction direction : kDirections) {
    for (const auto& [key, probability] : links[indexOf(direction)]) {
      seeds.push_back(
          {static_cast<Cell>(key >> 32), static_cast<Cell>(key), direction, probability});
    }
  }
  std::sort(seeds.begin(), seeds.end(), kSurestFirst);
  Links out;
  for (const Link& seed : seeds) {
    const std::uint64_t key = keyOf(seed.newer, seed.older);
    if (!out[indexOf(seed.direction)].emplace(key, seed.probability).second) continue;
    extend(seed, -1, &out);
    extend(seed, 1, &out);
  }
  return out;
}

/// The links of each cell, those to the oldest cells first.
SharedMatches::Rows SharedMatches::rowsOf(const Links& links) const {
  Rows rows;
  for (std::size_t d = 0; d < rows.size(); ++d) {
    rows[d].resize(cells());
    for (const auto& [key, probability] : links[d]) {
      const auto newer = static_cast<Cell>(key >> 32), older = static_cast<Cell>(key);
      const float weight = weightOf(probability);
      rows[d][newer].push_back({older, probability, weight, 0.0});
      rows[d][older].push_back({newer, probability, weight, 0.0});
    }
    for (auto& row : rows[d]) {
      std::sort(row.begin(), row.end(),
                [](const Neighbour& a, const Neighbour& b) { return a.cell < b.cell; });
      double sum = 0.0;
      for (Neighbour& n : row) n.sum = sum += static_cast<double>(n.weight);
    }
  }
  return rows;
}

void SharedMatches::compare(Cell newer, Direction direction, const Rows& rows,
                            std::vector<double>* shared,
                            std::vector<SimilarObservations>* pairs) const {
  const auto weightBefore = [&](Cell cell) {
    double sum = 0.0;
    for (const auto& of_direction : rows) {
      const auto& row = of_direction[cell];
      const auto end = std::lower_bound(row.begin(), row.end(), newer,
                                        [](const Neighbour& n, Cell at) { return n.cell < at; });
      if (end != row.begin()) sum += std::prev(end)->sum;
    }
    return sum;
  };
  std::vector<Cell> found;
  const auto add = [&](Cell cell, float weight) {
    double& sum = (*shared)[cell];
    if (sum == 0.0) found.push_back(cell);
    sum += static_cast<double>(weight);
  };
  for (const Direction first : kDirections) {
    const auto& second = rows[indexOf(composed(first, direction))];
    for (const Neighbour& n : rows[indexOf(first)][newer]) {
      if (n.cell >= newer) break;
      if (first == direction) add(n.cell, n.weight);
      for (const Neighbour& m : second[n.cell]) {
        if (m.cell >= newer || !apart(newer, m.cell)) break;
        add(m.cell, weightOf(n.probability * m.probability));
      }
    }
  }
  std::sort(found.begin(), found.end());
  const double own = params_.prior + weightBefore(newer);
  const ObservationStore& observations = recognizer_.observations();
  const auto end = [&](Cell cell) {
    return std::min(begin_[cell] + static_cast<std::uint32_t>(params_.cell),
                    observations.runEnd(run_[cell]));
  };
  for (const Cell older : found) {
    const double weight = std::exchange((*shared)[older], 0.0);
    const double similarity = weight / std::sqrt(own * (params_.prior + weightBefore(older)));
    if (similarity < params_.min_similarity) continue;
    const std::uint32_t count = std::min(end(newer) - begin_[newer], end(older) - begin_[older]);
    const std::uint32_t from =
        direction == Direction::kSame ? begin_[older] : begin_[older] + count - 1;
    pairs->push_back({begin_[newer], from, count, direction, similarity});
  }
}

std::vector<SimilarObservations> SharedMatches::of(std::vector<NgramMatch> matches) const {
  const Rows rows = rowsOf(extended(linksOf(std::move(matches))));
  std::vector<SimilarObservations> pairs;
  std::vector<double> shared(cells(), 0.0);
  for (Cell newer = 0; newer < cells(); ++newer) {
    for (const Direction direction : kDirections) compare(newer, direction, rows, &shared, &pairs);
  }
  return pairs;
}

}  // namespace ngram_slam

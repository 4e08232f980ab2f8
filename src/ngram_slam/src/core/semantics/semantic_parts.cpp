// What a cut of the density is made of, and what each part looks like.
#include <algorithm>
#include <cmath>

#include "ngram_slam/semantics/semantic_segmenter.hpp"
#include "ngram_slam/words/density_regions.hpp"
#include "ngram_slam/words/density_word.hpp"

namespace ngram_slam {
namespace {

constexpr int kManyFrontiers = 3;        // more than a corridor has
constexpr std::uint32_t kTurnReach = 5;  // 6.2.4: directions are compared over ten poses

double rise(const SemanticCut& cut, const std::optional<double>& neighbour) {
  return neighbour ? cut.level - *neighbour : 0.0;
}

/// A density that only turned has varied all the way; one that stood differs where it is above both
/// neighbours, as in a hall. Corridors stand below what they join.
double variationOf(const SemanticCut& cut) {
  const double before = rise(cut, cut.before), after = rise(cut, cut.after);
  if (!cut.steady) return std::max(std::abs(before), std::abs(after));
  if (!cut.before || !cut.after) return std::max(0.0, before + after);
  return std::max(0.0, std::min(before, after));
}

}  // namespace

double SemanticSegmenter::turnIn(std::uint32_t first, std::uint32_t last) const {
  double low = seen_[first - seen_begin_].heading, high = low;
  for (std::uint32_t i = first; i <= last; ++i) {
    low = std::min(low, seen_[i - seen_begin_].heading);
    high = std::max(high, seen_[i - seen_begin_].heading);
  }
  return high - low;
}

/// A bend in a region without many frontiers: the way before it, itself, the way behind it.
std::vector<SemanticCut> SemanticSegmenter::divideAtBend(const SemanticCut& cut) const {
  if (turnIn(cut.first, cut.last) < params_.bend_angle) return {cut};
  const auto heading = [&](std::uint32_t i) { return seen_[i - seen_begin_].heading; };
  // The robot turns where its heading changes within a metre.
  const auto turns = [&](std::uint32_t i) {
    const std::uint32_t from = i - std::min(i - cut.first, kTurnReach);
    const std::uint32_t to = std::min(cut.last, i + kTurnReach);
    return std::abs(heading(to) - heading(from)) > params_.min_turn;
  };
  std::uint32_t first = cut.first, last = cut.last;
  while (first < last && !turns(first)) ++first;
  while (last > first && !turns(last)) --last;
  const auto rim = static_cast<std::uint32_t>(params_.max_rim);
  if (first - cut.first <= rim) first = cut.first;
  if (cut.last - last <= rim) last = cut.last;
  std::vector<SemanticCut> out;
  if (first > cut.first) {
    out.push_back({cut.first, first - 1, cut.level, true, cut.before, cut.level});
  }
  out.push_back({first, last, cut.level, cut.steady, cut.before, cut.after});
  if (last < cut.last) out.push_back({last + 1, cut.last, cut.level, true, cut.level, cut.after});
  return out;
}

/// Along the number of frontiers, then along bends.
std::vector<SemanticCut> SemanticSegmenter::divideAtFrontiers(const SemanticCut& cut) const {
  if (params_.min_frontier_run == 0) return divideAtBend(cut);
  const auto seen = [&](std::uint32_t i) -> const Seen& { return seen_[i - seen_begin_]; };
  std::vector<DensityRegion> parts;  // of class 1 where there are many frontiers, else 0
  DensityRegionBuilder builder(params_.min_frontier_run, cut.first);
  for (std::uint32_t i = cut.first; i <= cut.last; ++i) {
    if (const auto part = builder.add(seen(i).frontiers >= kManyFrontiers ? 1 : 0)) {
      parts.push_back(*part);
    }
  }
  if (const auto part = builder.finish()) parts.push_back(*part);
  const auto isRim = [&](const DensityRegion& part) {
    return part.density_class == 0 && part.size() <= static_cast<std::uint32_t>(params_.max_rim);
  };
  if (parts.size() > 1 && isRim(parts.front())) {
    parts[1].begin = parts[0].begin;
    parts.erase(parts.begin());
  }
  if (parts.size() > 1 && isRim(parts.back())) {
    parts[parts.size() - 2].end = parts.back().end;
    parts.pop_back();
  }
  if (parts.empty()) return divideAtBend(cut);
  if (parts.size() == 1) {
    if (parts[0].density_class == 0) return divideAtBend(cut);
    SemanticCut whole = cut;
    whole.steady = false;
    return {whole};
  }
  std::vector<SemanticCut> out;
  for (const DensityRegion& part : parts) {
    SemanticCut c{part.begin, part.end - 1, 0.0, part.density_class == 0, cut.before, cut.after};
    double sum = 0.0;
    for (std::uint32_t i = c.first; i <= c.last; ++i) {
      sum += seen(i).soft;
      c.level = std::max(c.level, static_cast<double>(seen(i).soft));
    }
    if (c.steady) c.level = sum / part.size();
    if (!out.empty()) {
      out.back().after = c.level;
      c.before = out.back().level;
    }
    out.push_back(c);
  }
  std::vector<SemanticCut> all;
  for (const SemanticCut& c : out) {
    const std::vector<SemanticCut> bent = c.steady ? divideAtBend(c) : std::vector<SemanticCut>{c};
    all.insert(all.end(), bent.begin(), bent.end());
  }
  return all;
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
    f.many_frontiers += s.frontiers >= kManyFrontiers;
  }
  // Where one region passes into the next, frontiers come and go.
  const std::uint32_t quarter = (cut.last - cut.first + 1) / 4;
  for (std::uint32_t i = cut.first + quarter; i <= cut.last - quarter; ++i) {
    f.frontiers += seen(i).frontiers;
  }
  f.frontiers /= f.length - 2.0 * quarter;
  f.few_frontiers /= f.length;
  f.many_frontiers /= f.length;
  f.turn = turnIn(cut.first, cut.last);
  f.angle = std::abs(angleVariation(seen(cut.first).pose,
                                    seen(cut.first + (cut.last - cut.first) / 2).pose,
                                    seen(cut.last).pose));
  f.steady = cut.steady ? 1.0 : 0.0;
  return f;
}

}  // namespace ngram_slam

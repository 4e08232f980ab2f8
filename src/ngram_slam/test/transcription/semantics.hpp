// Chapter 6 written down plainly, over a whole run at once: where the density starts or stops to
// vary, what joins and divides the cuts, and the decision tree. The oracle of SemanticSegmenter and
// DecisionTree; slow on purpose.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "ngram_slam/semantics/semantic_segmenter.hpp"

namespace transcription {

using ngram_slam::SemanticClass;

struct Level {
  double reached;          // as known when it was reached: what the cut before is told
  double value;            // as known when it was left
  std::size_t begin, end;  // where the density stood or turned
  bool steady;
};

struct Piece {
  std::size_t first, last;
  double level;
  bool steady;
  bool has_before, has_after;
  double before, after;
};

inline std::vector<double> meanFiltered(const std::vector<double>& d, int reach) {
  std::vector<double> x;
  for (int i = 0; i < static_cast<int>(d.size()); ++i) {
    double sum = 0.0;
    int n = 0;
    for (int k = i - reach; k <= i + reach; ++k) {
      if (k < 0 || k >= static_cast<int>(d.size())) continue;
      sum += d[static_cast<std::size_t>(k)];
      ++n;
    }
    x.push_back(sum / n);
  }
  return x;
}

/// The density steady from `begin` on; its first `sure` values belong to it in any case.
inline Level standing(const std::vector<double>& x, std::size_t begin, std::size_t sure,
                      double change_threshold) {
  double sum = 0.0;
  std::size_t end = begin;
  while (end < begin + sure) sum += x[end++];
  const double reached = sum / static_cast<double>(sure);
  while (end < x.size() &&
         std::abs(x[end] - sum / static_cast<double>(end - begin)) <= change_threshold) {
    sum += x[end++];
  }
  return {reached, sum / static_cast<double>(end - begin), begin, end, true};
}

inline std::vector<Level> levels(const std::vector<double>& x,
                                 const ngram_slam::SemanticCutParams& p) {
  std::vector<Level> out{standing(x, 0, 1, p.change_threshold)};
  std::size_t since = out[0].end;  // of the move
  bool up = since < x.size() && x[since] > out[0].value;
  const auto extreme = [&](std::size_t to) {
    std::size_t e = since;
    for (std::size_t k = since; k <= to; ++k) {
      if (up ? x[k] > x[e] : x[k] < x[e]) e = k;
    }
    return e;
  };
  for (std::size_t i = since; i < x.size(); ++i) {
    const std::size_t e = extreme(i);
    if ((up ? x[e] - x[i] : x[i] - x[e]) > p.change_threshold) {
      out.push_back({x[e], x[e], e, e + 1, false});
      since = e + 1;
      up = !up;
    }
    const auto n = static_cast<std::size_t>(p.steady_length);
    if (i + 1 < since + n) continue;
    double low = x[i], high = x[i];
    for (std::size_t k = i + 1 - n; k <= i; ++k) {
      low = std::min(low, x[k]);
      high = std::max(high, x[k]);
    }
    if (high - low >= p.steady_tolerance) continue;
    out.push_back(standing(x, i + 1 - n, n, p.change_threshold));
    since = out.back().end;
    if (since == x.size()) return out;
    up = x[since] > out.back().value;
    i = since - 1;
  }
  if (since < x.size()) {
    const std::size_t e = extreme(x.size() - 1);
    out.push_back({x[e], x[e], e, e + 1, false});
  }
  return out;
}

inline std::vector<Piece> cuts(const std::vector<double>& densities,
                               const ngram_slam::SemanticCutParams& p) {
  if (densities.empty()) return {};
  const std::vector<double> x = meanFiltered(densities, p.smoothing);
  const std::vector<Level> all = levels(x, p);
  std::vector<Piece> out;
  std::size_t first = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    Piece c{first, x.size() - 1, all[k].value, all[k].steady, k > 0, k + 1 < all.size(), 0.0, 0.0};
    if (c.has_before) c.before = all[k - 1].value;
    if (c.has_after) {
      c.after = all[k + 1].reached;
      const double share = c.after > c.level ? p.border_share : 1.0 - p.border_share;
      std::size_t border = all[k].end;
      while (border < all[k + 1].begin &&
             std::abs(x[border] - c.level) < share * std::abs(c.after - c.level)) {
        ++border;
      }
      c.last = border - 1;
      first = border;
    }
    out.push_back(c);
  }
  return out;
}

/// A run: densities, frontiers, unwrapped headings.
struct Run {
  std::vector<double> soft;
  std::vector<int> frontiers;
  std::vector<double> heading;
};

inline double turn(const Run& run, std::size_t first, std::size_t last) {
  const auto at = [&](std::size_t i) { return run.heading.begin() + static_cast<long>(i); };
  const auto range = std::minmax_element(at(first), at(last + 1));
  return *range.second - *range.first;
}

/// A short or turning trough joins what is on both its sides.
inline std::vector<Piece> joined(const std::vector<Piece>& all, const Run& run,
                                 const ngram_slam::SemanticParams& p) {
  std::vector<Piece> out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Piece& c = all[k];
    const bool trough = c.has_before && c.has_after && c.before > c.level && c.after > c.level;
    const auto length = static_cast<int>(c.last - c.first + 1);
    const bool gap =
        length < p.min_gap || (length <= p.max_bend && turn(run, c.first, c.last) > p.min_turn);
    if (!(trough && gap)) {
      out.push_back(c);
      continue;
    }
    const Piece& next = all[++k];  // taken in as it is
    Piece& whole = out.back();
    whole.last = next.last;
    whole.level = std::max(whole.level, next.level);
    whole.has_after = next.has_after;
    whole.after = next.after;
  }
  return out;
}

inline std::vector<Piece> bent(const Piece& c, const Run& run,
                               const ngram_slam::SemanticParams& p) {
  if (turn(run, c.first, c.last) < p.bend_angle) return {c};
  std::vector<bool> turns;
  for (std::size_t i = c.first; i <= c.last; ++i) {
    const std::size_t from = i < c.first + 5 ? c.first : i - 5, to = std::min(c.last, i + 5);
    turns.push_back(std::abs(run.heading[to] - run.heading[from]) > p.min_turn);
  }
  const auto begin = std::find(turns.begin(), turns.end(), true);
  const auto rend = std::find(turns.rbegin(), turns.rend(), true);
  std::size_t first = c.last, last = c.last;  // nothing turns fast enough: all of it is before
  if (begin != turns.end()) {
    first = c.first + static_cast<std::size_t>(begin - turns.begin());
    last = c.last - static_cast<std::size_t>(rend - turns.rbegin());
  }
  if (first - c.first <= static_cast<std::size_t>(p.max_rim)) first = c.first;
  if (c.last - last <= static_cast<std::size_t>(p.max_rim)) last = c.last;
  std::vector<Piece> out;
  Piece before = c, itself = c, behind = c;
  before.last = first - 1;
  before.steady = before.has_after = true;
  before.after = c.level;
  itself.first = first;
  itself.last = last;
  behind.first = last + 1;
  behind.steady = behind.has_before = true;
  behind.before = c.level;
  if (first > c.first) out.push_back(before);
  out.push_back(itself);
  if (last < c.last) out.push_back(behind);
  return out;
}

inline std::vector<Piece> divided(const Piece& c, const Run& run,
                                  const ngram_slam::SemanticParams& p) {
  struct Stretch {
    bool many;
    std::size_t first, last;
  };
  // Stretches of equal values; those too short belong to what is before them, at the beginning to
  // what follows.
  std::vector<Stretch> parts;
  std::size_t unclaimed = c.first;
  for (std::size_t i = c.first, end; p.min_frontier_run > 0 && i <= c.last; i = end) {
    const bool many = run.frontiers[i] >= 3;
    for (end = i; end <= c.last && (run.frontiers[end] >= 3) == many;) ++end;
    if (static_cast<int>(end - i) >= p.min_frontier_run &&
        (parts.empty() || parts.back().many != many)) {
      parts.push_back({many, parts.empty() ? unclaimed : i, end - 1});
    } else if (!parts.empty()) {
      parts.back().last = end - 1;
    }
  }
  const auto rim = [&](const Stretch& s) {
    return !s.many && static_cast<int>(s.last - s.first) + 1 <= p.max_rim;
  };
  if (parts.size() > 1 && rim(parts.front())) {
    parts[1].first = c.first;
    parts.erase(parts.begin());
  }
  if (parts.size() > 1 && rim(parts.back())) {
    parts.pop_back();
    parts.back().last = c.last;
  }
  if (parts.empty() || (parts.size() == 1 && !parts[0].many)) return bent(c, run, p);
  if (parts.size() == 1) {
    Piece whole = c;
    whole.steady = false;
    return {whole};
  }
  std::vector<Piece> out;
  std::vector<double> value;
  for (const Stretch& s : parts) {
    double sum = 0.0, high = 0.0;
    for (std::size_t i = s.first; i <= s.last; ++i) {
      sum += static_cast<float>(run.soft[i]);
      high = std::max(high, static_cast<double>(static_cast<float>(run.soft[i])));
    }
    value.push_back(s.many ? high : sum / static_cast<double>(s.last - s.first + 1));
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    Piece part = c;
    part.first = parts[k].first;
    part.last = parts[k].last;
    part.level = value[k];
    part.steady = !parts[k].many;
    if (k > 0) {
      part.has_before = true;
      part.before = value[k - 1];
    }
    if (k + 1 < parts.size()) {
      part.has_after = true;
      part.after = value[k + 1];
    }
    if (parts[k].many) {
      out.push_back(part);
    } else {
      for (const Piece& b : bent(part, run, p)) out.push_back(b);
    }
  }
  return out;
}

inline std::vector<Piece> regions(const Run& run, const ngram_slam::SemanticParams& p) {
  std::vector<Piece> out;
  for (const Piece& whole : joined(cuts(run.soft, p.cut), run, p)) {
    for (const Piece& part : divided(whole, run, p)) out.push_back(part);
  }
  return out;
}

/// Fig. 6.8 with Table 6.4; low variation counts where the robot goes straight.
inline SemanticClass tree(const ngram_slam::SemanticFeatures& f,
                          const ngram_slam::DecisionTreeParams& p) {
  if (f.length > p.very_long) return SemanticClass::kCorridor;
  if (!(f.variation > p.high_variation) && f.turn < p.straight) return SemanticClass::kCorridor;
  if (f.frontiers < p.few_frontiers) {
    if (f.density_max > p.high_density) return SemanticClass::kHall;
    return SemanticClass::kCorridor;
  }
  if (f.frontiers > p.many_frontiers) return SemanticClass::kBifurcation;
  if (f.turn > p.huge_turn) return SemanticClass::kDeadEnd;
  if (f.turn < p.small_turn) return SemanticClass::kCorridor;
  return SemanticClass::kCorner;
}

}  // namespace transcription

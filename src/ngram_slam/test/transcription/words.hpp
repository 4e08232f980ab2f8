// Alg. 4.2, 4.3 and 5.2 as the thesis writes them (with the errata that are named). The oracles of
// DensityRegionBuilder, angleVariation and Text; slow on purpose.
#pragma once

#include <cmath>
#include <deque>
#include <list>
#include <memory>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace transcription {

struct Observed {
  int d = 0;  // density class
  hyselam::Pose2 x;
};
using Region = std::vector<Observed>;

/// Alg. 4.2. Nothing is popped that is not there, and what ends the region goes back to the front.
inline Region buildRegion(std::deque<Observed>& pending, std::size_t t_o) {
  Region r_new;
  if (pending.size() <= t_o) return r_new;
  Observed o = pending.front();
  pending.pop_front();
  const int d_new = o.d;
  while (o.d == d_new || r_new.size() <= t_o) {
    r_new.push_back(o);
    if (pending.empty()) return r_new;
    o = pending.front();
    pending.pop_front();
  }
  pending.push_front(o);
  return r_new;
}

/// The erratum of Alg. 4.2, over a whole run at once: runs of one class with fewer than t_o
/// observations are interruptions and belong to what is before them, at the start to what follows.
inline std::vector<std::pair<int, std::size_t>> regionsOfRun(const std::vector<int>& classes,
                                                             std::size_t t_o) {
  std::vector<std::pair<int, std::size_t>> stretches;  // class, observations
  for (int d : classes) {
    if (stretches.empty() || stretches.back().first != d) stretches.push_back({d, 0});
    ++stretches.back().second;
  }
  std::vector<std::pair<int, std::size_t>> regions;
  std::size_t unclaimed = 0;
  for (const auto& [d, n] : stretches) {
    if (n >= t_o && (regions.empty() || regions.back().first != d)) {
      regions.push_back({d, n + unclaimed});
      unclaimed = 0;
    } else if (regions.empty()) {
      unclaimed += n;
    } else {
      regions.back().second += n;
    }
  }
  return regions;
}

/// Line 3 of Alg. 4.3, with atan2 and wrapping (erratum).
inline double angle(const Region& r) {
  const auto& i = r.front().x;
  const auto& m = r[(r.size() - 1) / 2].x;
  const auto& f = r.back().x;
  const auto direction = [](const hyselam::Pose2& from, const hyselam::Pose2& to, double heading) {
    const double dx = to.x - from.x, dy = to.y - from.y;
    return std::sqrt(dx * dx + dy * dy) < 0.05 ? heading : std::atan2(dy, dx);
  };
  double a = direction(m, f, f.theta) - direction(i, m, i.theta);
  while (a > hyselam::kPi) a -= 2 * hyselam::kPi;
  while (a <= -hyselam::kPi) a += 2 * hyselam::kPi;
  return a;
}

/// Eq. 5.1.
struct ExtendedWord {
  int d = 0;
  std::size_t s = 0;
  double a = 0.0;
  std::list<const ExtendedWord*> P;
  Region O;
  int level = 0;
  std::size_t first = 0, last = 0;  // level-0 words covered, to tell words apart
};

inline ExtendedWord buildExtendedWord(const Region& r) {
  ExtendedWord w;
  w.d = r.front().d;
  w.s = r.size();
  w.a = angle(r);
  w.O = r;
  return w;
}

/// Alg. 5.2, for one run: the lists W_0 .. W_L.
struct MultiLevelWords {
  explicit MultiLevelWords(int top_level) : W(static_cast<std::size_t>(top_level) + 1) {}
  std::vector<std::vector<std::unique_ptr<ExtendedWord>>> W;

  void add(const Region& r) {
    auto made = std::make_unique<ExtendedWord>(buildExtendedWord(r));
    ExtendedWord* w_new = made.get();
    const std::size_t n = W[0].size();  // before the push (erratum)
    w_new->first = w_new->last = n;
    ExtendedWord* w_last = n > 0 ? W[0][n - 1].get() : nullptr;
    if (w_last != nullptr) w_new->P.push_back(w_last);
    W[0].push_back(std::move(made));
    for (std::size_t l = 1; l < W.size(); ++l) {
      if (n < l + 2) break;
      const ExtendedWord* w_first = W[0][n - l - 2].get();
      if (w_first->d != w_last->d) continue;
      Region joined;
      for (std::size_t k = n - l - 2; k < n; ++k) {
        joined.insert(joined.end(), W[0][k]->O.begin(), W[0][k]->O.end());
      }
      auto w_alt = std::make_unique<ExtendedWord>(buildExtendedWord(joined));
      w_alt->P = w_first->P;
      w_alt->level = static_cast<int>(l);
      w_alt->first = n - l - 2;
      w_alt->last = n - 1;
      w_new->P.push_back(w_alt.get());
      W[l].push_back(std::move(w_alt));
    }
  }
};

}  // namespace transcription

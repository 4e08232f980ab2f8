#include "stamp_repair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyselam {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);
constexpr double kDefaultStep = 0.1;  // [s], where a single kept stamp gives none

/// Indices of a longest increasing (or non-decreasing) subsequence of the usable stamps.
std::vector<std::size_t> longestOrdered(const std::vector<double>& stamps, bool strict) {
  std::vector<std::size_t>
      tails;  // tails[k]: index of the smallest end of a sequence of length k + 1
  std::vector<std::size_t> previous(stamps.size(), kNone);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (!(stamps[i] >= 0.0 && stamps[i] <= kMaxStamp)) continue;
    const auto position =
        strict ? std::lower_bound(tails.begin(), tails.end(), stamps[i],
                                  [&](std::size_t t, double s) { return stamps[t] < s; })
               : std::upper_bound(tails.begin(), tails.end(), stamps[i],
                                  [&](double s, std::size_t t) { return s < stamps[t]; });
    // Of two equal stamps the first one stays.
    if (strict && position != tails.end() && stamps[*position] == stamps[i]) continue;
    if (position != tails.begin()) previous[i] = *(position - 1);
    if (position == tails.end()) {
      tails.push_back(i);
    } else {
      *position = i;
    }
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = tails.empty() ? kNone : tails.back(); i != kNone; i = previous[i]) {
    kept.push_back(i);
  }
  std::reverse(kept.begin(), kept.end());
  return kept;
}

}  // namespace

RepairedStamps repairStamps(const std::vector<double>& stamps, bool strict) {
  RepairedStamps result{stamps, {}};
  const std::vector<std::size_t> kept = longestOrdered(stamps, strict);
  if (kept.empty()) {
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      result.stamps[i] = kDefaultStep * static_cast<double>(i);
      result.changed.push_back(i);
    }
    return result;
  }
  const std::size_t first = kept.front(), last = kept.back();
  const double step = kept.size() > 1
                          ? (stamps[last] - stamps[first]) / static_cast<double>(last - first)
                          : kDefaultStep;
  std::size_t next = 0;  // in kept: the first one at or after i
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (next < kept.size() && kept[next] == i) {
      ++next;
      continue;
    }
    double& stamp = result.stamps[i];
    if (next == 0) {
      // Squeezed in where going on backwards would lead below 0.
      const double room = std::min(step, stamps[first] / static_cast<double>(first));
      stamp = stamps[first] - room * static_cast<double>(first - i);
    } else if (next == kept.size()) {
      stamp = std::min(stamps[last] + step * static_cast<double>(i - last), kMaxStamp);
    } else {
      const std::size_t a = kept[next - 1], b = kept[next];
      stamp = stamps[a] +
              (stamps[b] - stamps[a]) * static_cast<double>(i - a) / static_cast<double>(b - a);
    }
    result.changed.push_back(i);
  }
  // Neighbours without room between them.
  double previous = -1.0;
  for (double& stamp : result.stamps) {
    if (strict && !(stamp > previous)) {
      stamp = std::numeric_limits<double>::quiet_NaN();
    } else {
      previous = stamp;
    }
  }
  return result;
}

}  // namespace hyselam

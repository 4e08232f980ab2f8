// What merge_maps advises where maps stay apart that may be of one building.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "ngram_slam/slam/map_merging.hpp"

namespace ngram_slam {

/// Of each two sessions that lie in no common map though the scans verified many loops between
/// them, of which none was believed: what else can be tried, a line each; empty: there are none.
/// `labels`: names of the sessions, as given; `place_interval`: as merged with [m].
inline std::string adviceOn(const MergedMaps& merged, const std::vector<std::string>& labels,
                            double place_interval) {
  constexpr int kMany = 20;  // two buildings that are alike have some as well
  const auto isOf = [](const MergedMap& map, std::size_t session) {
    return std::any_of(map.parts.begin(), map.parts.end(),
                       [&](const MergedPart& part) { return part.session == session; });
  };
  std::string advice;
  for (const MapMeeting& m : merged.meetings) {
    if (m.far_loops > 0 || m.doubted < kMany ||
        std::any_of(merged.maps.begin(), merged.maps.end(),
                    [&](const MergedMap& map) { return isOf(map, m.a) && isOf(map, m.b); })) {
      continue;
    }
    const std::string &a = labels[m.a], &b = labels[m.b];
    advice += a + " and " + b + ": " + std::to_string(m.doubted) +
              " loops verified, none believed: they may have too few metres in common. To try: " +
              (place_interval > 0.0 ? "" : "merge_maps --place-interval 2, or ") + "slam_offline " +
              "--bag (of " + b + ") --state (" + a + ") --start unknown.\n";
  }
  if (!advice.empty()) advice += "Look at that map: corridors that repeat may be tied wrongly.\n";
  return advice;
}

}  // namespace ngram_slam

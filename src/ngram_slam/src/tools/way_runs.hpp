// What the tools of kinds along ways have in common: recorded runs as places with stamps and the
// true poses.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "ngram_slam/semantics/way_forest.hpp"
#include "place_logs.hpp"

namespace ngram_slam {

/// Places that follow each other without a jump of the odometry.
struct WayRun {
  std::vector<WayPlace> places;
  std::vector<double> stamps;
  std::vector<std::optional<hyselam::Pose2>> truth;
};

inline std::vector<WayRun> wayRunsOf(const PlaceLog& log) {
  std::vector<WayRun> runs;
  for (const LogPlace& p : log.places) {
    if (runs.empty() || p.on_way.way <= runs.back().places.back().way) runs.emplace_back();
    runs.back().places.push_back({p.on_way.way, p.on_way.pose, wayShapeOf(p.features)});
    runs.back().stamps.push_back(p.stamp);
    runs.back().truth.push_back(p.truth);
  }
  return runs;
}

/// The classes at other stamps of the log: those of the places nearest in time.
inline std::vector<SemanticClass> classesAt(const std::vector<double>& stamps,
                                            const std::vector<WayRun>& runs,
                                            const WayForest& forest,
                                            const WayDecisionParams& params) {
  std::vector<std::pair<double, SemanticClass>> known;
  for (const WayRun& run : runs) {
    const std::vector<SemanticPrediction> predictions = forest.classify(run.places, params);
    for (std::size_t i = 0; i < predictions.size(); ++i) {
      known.emplace_back(run.stamps[i], predictions[i].semantic_class);
    }
  }
  std::stable_sort(known.begin(), known.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<SemanticClass> out;
  for (const double stamp : stamps) {
    const auto after = std::lower_bound(known.begin(), known.end(), stamp,
                                        [](const auto& k, double s) { return k.first < s; });
    const bool use_before =
        after != known.begin() &&
        (after == known.end() || stamp - (after - 1)->first < after->first - stamp);
    out.push_back(known.empty() ? SemanticClass::kCorridor
                                : (use_before ? after - 1 : after)->second);
  }
  return out;
}

}  // namespace ngram_slam

// What the tools of semantic classes have in common: options, runs with their true classes.
#pragma once

#include <string>
#include <vector>

#include "hyselam_common/tool.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "ngram_slam/semantics/semantic_score.hpp"
#include "ngram_slam/semantics/semantic_segmenter.hpp"
#include "ngram_slam/words/log_observations.hpp"

namespace ngram_slam {

struct SemanticRunOptions {
  SemanticParams semantics;
  LogObservationParams observations;

  void addTo(CLI::App& app) {
    app.option_defaults()->always_capture_default();
    app.add_option("--bandwidth", observations.bandwidth, "radius of the density kernel [m]");
    app.add_option("--usable-range", observations.usable_range,
                   "beams are cut at this range [m]; 0: as the local map is wide");
    app.add_option("--smoothing", semantics.cut.smoothing,
                   "observations on each side in the mean of densities");
    app.add_option("--leave", semantics.cut.change_threshold, "density varies from this change on");
    app.add_option("--settled", semantics.cut.steady_tolerance, "density steady within this range");
    app.add_option("--border", semantics.cut.border_share,
                   "share of the change of density that is made at a border");
  }
};

/// One run cut and classified, and what the plan says about it.
struct SemanticRun {
  std::vector<double> stamps;
  std::vector<SemanticRegion> regions;
  std::vector<std::optional<SemanticClass>> truth;  ///< empty without plan
};

/// What a plan says of the places where the robot truly was.
inline std::vector<std::optional<SemanticClass>> truthOf(const hyselam::RobotLog& log,
                                                         const std::vector<double>& stamps,
                                                         const hyselam_sim::FloorPlan& plan) {
  std::vector<std::optional<SemanticClass>> truth;
  for (const double stamp : stamps) {
    const auto pose = hyselam::poseAt(log.ground_truth, stamp, 0.5);
    truth.push_back(pose ? semanticClassFromString(plan.kindAt({pose->x, pose->y})) : std::nullopt);
  }
  return truth;
}

inline SemanticRun semanticRun(const hyselam::RobotLog& log, const SemanticRunOptions& options,
                               std::shared_ptr<const SemanticClassifier> classifier,
                               const hyselam_sim::FloorPlan* plan,
                               const std::function<void(std::size_t)>& progress = {}) {
  SemanticRun run;
  SemanticSegmenter segmenter(options.semantics, std::move(classifier));
  const auto keep = [&](const std::vector<SemanticRegion>& regions) {
    run.regions.insert(run.regions.end(), regions.begin(), regions.end());
  };
  for (const DensityObservation& o :
       observationsOf(log, options.observations, progress).observations) {
    run.stamps.push_back(o.stamp);
    keep(segmenter.add(o));
  }
  if (plan != nullptr) run.truth = truthOf(log, run.stamps, *plan);
  keep(segmenter.finish());
  return run;
}

inline std::vector<SemanticClass> classesOf(const SemanticRun& run) {
  std::vector<SemanticClass> out;
  for (const SemanticRegion& r : run.regions) {
    out.insert(out.end(), r.last - r.first + 1, r.semantic_class);
  }
  return out;
}

inline nlohmann::json toJson(const SemanticConfusion& confusion) {
  nlohmann::json j;
  const auto number = [](const std::optional<double>& x) {
    return x ? nlohmann::json(*x) : nlohmann::json(nullptr);
  };
  for (SemanticClass c : kAllSemanticClasses) {
    j["classes"][toString(c)] = {{"actual", confusion.actual(c)},
                                 {"predicted", confusion.predicted(c)},
                                 {"precision", number(confusion.precision(c))},
                                 {"recall", number(confusion.recall(c))}};
  }
  j["average_precision"] = confusion.averagePrecision();
  j["average_recall"] = confusion.averageRecall();
  j["accuracy"] = confusion.accuracy();
  j["confusion"] = confusion.counts;
  return j;
}

}  // namespace ngram_slam

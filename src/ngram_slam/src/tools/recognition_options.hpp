// What both offline tools have in common: options, and a recognizer fed with logs.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/words/log_observations.hpp"
#include "ngram_slam/words/observation_sampler.hpp"

namespace ngram_slam {

struct RecognitionOptions {
  std::vector<std::string> logs;
  hyselam::BagOptions bag_options;
  NgramRecognizerParams recognizer;
  LogObservationParams observations;
  double angle_deg = 30.0;
  std::vector<int> min_n;
  bool full_density = false, improved = false;

  void addTo(CLI::App& app) {
    app.option_defaults()->always_capture_default();
    app.add_option("logs", logs, "bags or CARMEN logs, plain or gzip: one run each, in this order")
        ->required();
    hyselam::addBagOptions(app, &bag_options);
    app.add_option("--levels", recognizer.levels, "levels of words");
    app.add_option("--min-n", min_n, "least words of a match, one number per level (7,10,13,...)")
        ->delimiter(',');
    app.add_option("--size-tolerance", recognizer.matcher.tolerance.size, "epsilon_s");
    app.add_option("--angle-tolerance", angle_deg, "epsilon_a [deg]");
    app.add_option("--min-region", recognizer.min_region, "t_o: least observations of a region");
    app.add_option("--classes", recognizer.uniform_classes, "density classes of equal width");
    app.add_flag("--mean-shift", recognizer.learn_classes, "density classes by mean shift instead");
    app.add_option("--bandwidth", observations.bandwidth, "radius of the density kernel [m]");
    app.add_option("--resolution", observations.resolution, "of the local map [m]");
    app.add_option("--usable-range", observations.usable_range,
                   "beams say nothing beyond it [m]; 0: all that fits the local map");
    app.add_option("--step", observations.step, "way between observations [m]");
    app.add_flag("--improved", improved,
                 "what goes beyond the thesis: --full-density with a --look-back of the kernel's "
                 "radius and 0.5 m, --reverse, --min-n 3,3,3 and --min-probability 0.75, as far as "
                 "nothing else is given");
    app.add_flag("--reverse", recognizer.reverse,
                 "also find places travelled the other way before");
    app.add_option("--look-back", observations.look_back,
                   "way after which the density of a spot is taken again, for --full-density [m]");
    app.add_flag("--full-density", full_density,
                 "words of the density seen from --look-back farther on");
    app.add_option("--class-hysteresis", recognizer.class_hysteresis,
                   "a density keeps its class this far beyond the class' bounds");
    app.add_option(
        "--max-chance", recognizer.max_chance,
        "tell a match if fewer than this many are expected by chance; give small --min-n");
    app.add_flag("--probability", recognizer.with_probability,
                 "the probability of each match to be right");
    app.add_option("--min-probability", recognizer.min_probability,
                   "tell only matches at least this probable");
  }
  LogObservationParams observationParams() const {
    LogObservationParams p = observations;
    if (improved && p.look_back == 0.0) p.look_back = p.bandwidth + 0.5;
    return p;
  }
  /// The parameters, completed. @throws hyselam::ParameterError
  NgramRecognizerParams params() const {
    NgramRecognizerParams p = recognizer;
    const WordLattice level_check(p.levels);
    p.word_density = full_density ? WordDensity::kFull : WordDensity::kSoft;
    p.matcher.tolerance.angle = hyselam::radians(angle_deg);
    p.matcher.min_n = min_n;
    if (improved) {
      const NgramRecognizerParams better = NgramRecognizerParams::improved();
      p.word_density = better.word_density;
      p.reverse = better.reverse;
      p.with_probability = better.with_probability;
      if (p.min_probability == 0.0) p.min_probability = better.min_probability;
      if (min_n.empty()) {
        p.matcher.min_n.assign(static_cast<std::size_t>(p.levels), better.matcher.min_n.front());
      }
    }
    for (int l = static_cast<int>(p.matcher.min_n.size()); l < p.levels; ++l) {
      p.matcher.min_n.push_back(l == 0 ? 7 : p.matcher.min_n.back() + 3);
    }
    p.matcher.min_n.resize(static_cast<std::size_t>(p.levels));
    p.validate();
    return p;
  }
};

/// The observations of one log, at least one.
struct Run {
  std::vector<DensityObservation> observations;
};

/// @throws hyselam::InputError for a log that cannot be read or of which no scan can be used.
inline std::vector<Run> readRuns(const RecognitionOptions& options) {
  std::vector<Run> runs;
  for (const std::string& path : options.logs) {
    const hyselam::RobotLog log = hyselam::readRobotLog(path, options.bag_options);
    hyselam::Progress progress("densities of " + path, log.scans.size());
    LogObservations seen = observationsOf(log, options.observationParams(),
                                          [&](std::size_t done) { progress.update(done); });
    if (seen.observations.empty()) {
      throw hyselam::InputError(path, "",
                                "gives no observations: of " + std::to_string(log.scans.size()) +
                                    " scans " + std::to_string(seen.scans_without_odometry) +
                                    " have no odometry, " + std::to_string(seen.scans_refused) +
                                    " cannot be used");
    }
    runs.push_back({std::move(seen.observations)});
  }
  return runs;
}

/// Feeds all runs. `use` gets what each observation brought about.
inline void feed(const std::vector<Run>& runs, NgramRecognizer& recognizer,
                 const std::function<void(const NgramRecognizerUpdate&)>& use) {
  for (const Run& run : runs) {
    const DensityObservation* before = nullptr;
    for (const DensityObservation& o : run.observations) {
      if (before != nullptr && odometryJumped(*before, o)) use(recognizer.endRun());
      use(recognizer.add(o));
      before = &o;
    }
    use(recognizer.endRun());
  }
}
inline void feed(const RecognitionOptions& options, NgramRecognizer& recognizer,
                 const std::function<void(const NgramRecognizerUpdate&)>& use) {
  feed(readRuns(options), recognizer, use);
}

}  // namespace ngram_slam

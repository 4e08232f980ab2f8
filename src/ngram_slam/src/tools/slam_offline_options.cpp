#include "slam_offline_options.hpp"

#include <iostream>
#include <memory>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/file_param_source.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

using hyselam::Pose2;

void addOptions(CLI::App& app, SlamOfflineOptions* o) {
  app.option_defaults()->always_capture_default();
  auto* bag = app.add_option("--bag", o->bag, "bag with scans and odometry");
  auto* carmen = app.add_option("--carmen", o->carmen, "CARMEN log, plain or gzip");
  bag->excludes(carmen);
  app.add_option("--out", o->out, "folder for what is written")->required();
  app.add_option(
      "--parameters", o->parameters,
      "YAML file with parameters of the node, as in config/slam.yaml; options given here "
      "win over it");
  hyselam::addBagOptions(app, &o->bag_options);
  app.add_option("--levels", o->levels, "levels of words");
  app.add_option("--seed", o->seed, "of the errors of --odometry-noise");
  app.add_option(
      "--loops", o->loops,
      "none, proximity, ngrams (far places by words only), signatures (far places by their "
      "signatures only), all, or thesis (words accepted without verification)");
  app.add_option("--loop-latency", o->loop_latency,
                 "loops and optimizations count at the first scan taken this long after the one at "
                 "which they were begun [s], as in the nodelet; 0: before the next scan");
  app.add_option(
      "--reference", o->reference,
      "poses to compare with: TUM, a table with one pose for each scan, or a corrected log");
  app.add_option("--resolution", o->resolution, "of the map [m]");
  app.add_option("--odometry-noise", o->noise,
                 "add errors to the odometry: this many per cent of distance and rotation, and as "
                 "many centiradians a meter");
  addDegradationOptions(app, &o->degradation);
  app.add_flag("--correct-laser", o->correct_laser,
               "where the recording shows that the laser is mounted elsewhere than told, map it "
               "again with the laser there");
  app.add_option("--state", o->state,
                 "a saved map to go on with; trajectory.tum has the poses of this recording, "
                 "trajectory_map.tum those of all");
  app.add_option("--start", o->start,
                 "where the robot stands in the saved map, X,Y,THETA [m, rad], or unknown; without "
                 "it, where the last run ended");
  app.add_option("--save-state", o->save_state, "file for the map, to go on with later");
  app.add_flag("--keep-all", o->keep_all,
               "keep all keyframes of the maps that are loaded and saved, whether they add to "
               "them or not");
  app.add_flag("--raw-odometry", o->raw_odometry, "do not refine the odometry by scans");
  app.add_flag("--side-by-side", o->side_by_side,
               "the same without loops and in thesis mode too, for the report");
}

void loadParameters(const CLI::App& app, SlamOfflineOptions* o) {
  o->loops_given = app.count("--loops") > 0;
  if (o->parameters.empty()) return;
  hyselam::ParamLoader loader(std::make_shared<hyselam::FileParamSource>(o->parameters));
  const SlamServerParams p = loadSlamParams(loader);
  hyselam::requireAllKnown(loader, o->parameters);
  for (const std::string& renamed : loader.reportRenamed()) {
    std::cerr << "warning: " << renamed << "\n";
  }
  o->slam = p.slam;
  o->map = p.map;
  const auto take = [&](const std::string& option, auto& value, const auto& loaded) {
    if (app.count(option) == 0) value = loaded;
  };
  take("--loops", o->loops, toString(p.slam.loops));
  take("--levels", o->levels, p.slam.words.levels);
  take("--loop-latency", o->loop_latency, p.slam.loop_latency);
  take("--resolution", o->resolution, p.map.resolution);
  take("--raw-odometry", o->raw_odometry, !p.slam.refine_odometry);
  take("--keep-all", o->keep_all, !p.slam.consolidation.enabled);
  take("--odom-frame", o->bag_options.odom_frame, p.input.odom_frame_id);
  take("--base-frame", o->bag_options.base_frame, p.input.base_frame_id);
}

void checkOptions(const SlamOfflineOptions& o) {
  slamParamsOf(o, loopClosureModeFromString(o.loops));
  if (!(o.noise >= 0.0)) throw hyselam::ParameterError("odometry-noise", o.noise, "at least 0");
  if (!o.start.empty() && o.state.empty())
    throw hyselam::InputError("--start", o.start, "is a place in a saved map: give --state too");
  if (!o.start.empty() && o.start != "unknown") parseStart(o.start);
  const PresentMap map_check(mapParamsOf(o), {});
}

SlamParams slamParamsOf(const SlamOfflineOptions& o, LoopClosureMode loops) {
  if (o.levels < 1 || o.levels > WordLattice::kMaxLevels)
    throw hyselam::ParameterError("levels", o.levels,
                                  "from 1 to " + std::to_string(WordLattice::kMaxLevels));
  SlamParams params = o.slam;
  if (loops == LoopClosureMode::kThesis && (o.loops_given || o.slam.loops != loops)) {
    // What makes the thesis' words; all else stays as the file has it.
    const SlamParams thesis = SlamParams::thesis(o.levels);
    params.observations.look_back = thesis.observations.look_back;
    params.words = thesis.words;
  } else if (o.levels != params.words.levels) {
    params.words.levels = o.levels;
    params.words.matcher.min_n.assign(static_cast<std::size_t>(o.levels),
                                      params.words.matcher.min_n.front());
  }
  params.loops = loops;
  params.loop_latency = o.loop_latency;
  params.refine_odometry = !o.raw_odometry;
  params.consolidation.enabled = !o.keep_all;
  params.validate();
  return params;
}

hyselam::OccupancyMapperParams mapParamsOf(const SlamOfflineOptions& o) {
  hyselam::OccupancyMapperParams p = o.map;
  p.resolution = o.resolution;
  return p;
}

Pose2 parseStart(const std::string& text) {
  Pose2 pose;
  char comma = 0, other = 0;
  std::istringstream in(text);
  if (!(in >> pose.x >> comma >> pose.y >> other >> pose.theta) || comma != ',' || other != ',' ||
      !(in >> std::ws).eof() || !pose.isFinite()) {
    throw hyselam::InputError("--start", text, "is neither X,Y,THETA nor unknown");
  }
  return pose;
}

}  // namespace ngram_slam

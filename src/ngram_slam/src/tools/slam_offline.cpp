// slam_offline: a recorded run through the same SLAM as the nodelet, without a master.
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "degrade.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/report_issues.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/ros/file_param_source.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"
#include "loop_table.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "ngram_slam/semantics/semantic_regions_io.hpp"
#include "ngram_slam/slam/background_jobs.hpp"
#include "ngram_slam/slam/laser_mount.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "ngram_slam/slam/standing_odometry.hpp"
#include "reference_poses.hpp"
#include "report_page.hpp"
#include "slam_report.hpp"
#include "tool_parts.hpp"
#include "word_tables.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using hyselam::Pose2;

constexpr double kGapsOfScans = 0.2;  // more of them are no gaps

struct Options {
  std::string bag, carmen, out, parameters, reference, loops = "all", state, save_state, start;
  int levels = 3;
  std::uint64_t seed = 1;
  double noise = 0.0, resolution = 0.05, loop_latency = SlamParams{}.loop_latency;
  bool loops_given = false;  ///< on the command line
  bool side_by_side = false, raw_odometry = false, keep_all = false, correct_laser = false;
  Degradation degradation;
  hyselam::BagOptions bag_options;
  /// Of the map that is written.
  hyselam::OccupancyMapperParams map;
  /// Without --parameters the defaults; else those of the file.
  SlamParams slam;
};

/// The parameters of the node, from a file; options on the command line win over them.
/// @throws hyselam::InputError, hyselam::ParameterError
void loadParameters(const CLI::App& app, Options* o) {
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

double peakMegabytes() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) / 1024.0;
}

/// Whether a file that is no bag can be read as a CARMEN log.
bool isCarmenLog(const std::string& path) {
  try {
    hyselam::readCarmenLog(path);
    return true;
  } catch (const hyselam::InputError&) {
    return false;
  }
}

/// `issues`: lines of a CARMEN log that could not be taken as they stand.
hyselam::RobotLog readLog(const Options& o, std::vector<hyselam::CarmenIssue>* issues) {
  if (o.bag.empty() == o.carmen.empty())
    throw hyselam::InputError("slam_offline", "", "needs either --bag or --carmen");
  if (!o.carmen.empty()) return hyselam::readCarmenLog(o.carmen, {}, issues);
  try {
    return hyselam::readBag(o.bag, o.bag_options);
  } catch (const hyselam::InputError&) {
    if (!isCarmenLog(o.bag)) throw;
    throw hyselam::InputError(o.bag, "", "is no bag but a CARMEN log: try --carmen " + o.bag);
  }
}

/// What could not be taken of the log, in a sentence; empty if all could.
std::string troubleOf(const std::vector<hyselam::CarmenIssue>& issues) {
  const auto count = [&](hyselam::CarmenIssue::Kind kind) {
    return std::count_if(issues.begin(), issues.end(),
                         [&](const hyselam::CarmenIssue& i) { return i.kind == kind; });
  };
  const auto skipped = count(hyselam::CarmenIssue::Kind::kSkipped);
  const auto retimed = count(hyselam::CarmenIssue::Kind::kRetimed);
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  const auto lines = [](std::ptrdiff_t n, const std::string& one, const std::string& several) {
    return std::to_string(n) +
           (n == 1 ? " line of the log " + one : " lines of the log " + several);
  };
  if (skipped > 0) add(lines(skipped, "was", "were") + " skipped (truncated or not understood)");
  if (retimed > 0) add(lines(retimed, "has", "have") + " another time now: theirs is out of order");
  for (const hyselam::CarmenIssue& i : issues) {
    if (i.kind == hyselam::CarmenIssue::Kind::kLog) add(i.reason);
  }
  return text;
}

/// Adds errors to each motion: standard deviations of `factor` times 1 % of the distance in both
/// directions, and of 1 % of the rotation and 0.01 rad a meter in heading.
void addOdometryNoise(double factor, std::uint64_t seed,
                      std::vector<hyselam::StampedPose2>* odometry) {
  hyselam::Rng rng(seed);
  Pose2 last, noisy;
  for (std::size_t i = 0; i < odometry->size(); ++i) {
    Pose2& pose = (*odometry)[i].pose;
    if (i == 0) {
      last = noisy = pose;
      continue;
    }
    Pose2 step = between(last, pose);
    last = pose;
    const double distance = std::hypot(step.x, step.y), angle = std::abs(step.theta);
    // White along the path: variances of steps add up to that of a meter.
    const double stddev = 0.01 * factor * std::sqrt(distance);
    step.x += rng.gaussian(0.0, stddev);
    step.y += rng.gaussian(0.0, stddev);
    step.theta += rng.gaussian(0.0, stddev + 0.01 * factor * angle);
    noisy = noisy * step;
    pose = noisy;
  }
}

/// Where the robot of a recording stands at its beginning in a saved map: "X,Y,THETA" [m, rad].
/// @throws hyselam::InputError
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

/// The poses of the recording's own scans; those of the saved map come before them.
std::vector<hyselam::StampedPose2> ownTrajectory(const SlamEngine& engine, std::size_t saved) {
  auto all = engine.trajectory();
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(saved));
  return all;
}

struct Run {
  std::unique_ptr<SlamEngine> engine;
  std::size_t saved_scans = 0, saved_keyframes = 0;  ///< of the map that it goes on with
  std::uint64_t saved_counts = 0;                    ///< scans that it has counted
  std::size_t without_odometry = 0, refused = 0;
  double cpu = 0.0;
};

/// The engine that goes on with the saved map, if there is one.
std::unique_ptr<SlamEngine> makeEngine(const Options& o, const SlamParams& params) {
  if (o.state.empty()) return std::make_unique<SlamEngine>(params);
  SlamState state = SlamStateFile::load(o.state, params.surface);
  auto engine =
      std::make_unique<SlamEngine>(params, consolidated(std::move(state), params.consolidation));
  if (o.start == "unknown") {
    engine->startRunAnywhere();
  } else if (!o.start.empty()) {
    engine->startRun(parseStart(o.start));
  }
  return engine;
}

Run runSlam(const hyselam::RobotLog& log, std::unique_ptr<SlamEngine> engine,
            const std::string& label) {
  const double begin = cpuSeconds();
  Run run;
  run.engine = std::move(engine);
  run.saved_scans = run.engine->trajectory().size();
  run.saved_keyframes = run.engine->keyframes().size();
  run.saved_counts = run.engine->counters().scans;
  BackgroundJobs jobs(run.engine->params().loop_latency);
  hyselam::Progress progress(label, log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    progress.update(i + 1);
    const auto odometry = hyselam::poseAt(log.odometry, log.scans[i].stamp, 0.2);
    if (!odometry) {
      ++run.without_odometry;
      continue;
    }
    const double stamp = log.scans[i].stamp;
    while (!jobs.takeIn(stamp, run.engine.get())) jobs.runHere();
    try {
      run.engine->add(log.scans[i], *odometry);
      jobs.noteScan(stamp, run.engine.get());
    } catch (const hyselam::InputError&) {
      ++run.refused;
    }
  }
  jobs.runAll(run.engine.get());
  run.engine->endRun();
  while (const auto job = run.engine->takeFinalJob()) run.engine->apply(runJob(*job));
  run.cpu = cpuSeconds() - begin;
  return run;
}

hyselam::OccupancyMapperParams mapParamsOf(const Options& o) {
  hyselam::OccupancyMapperParams p = o.map;
  p.resolution = o.resolution;
  return p;
}

PresentMap mapOf(const SlamEngine& engine, const Options& o) {
  PresentMap map(mapParamsOf(o), engine.params().consolidation.present);
  map.update({engine.keyframes(), engine.settled(), engine.shownRuns(), engine.firstRunOfSession(),
              engine.revision()});
  return map;
}

/// A line for each thing that came or went since the saved map.
void writeChanges(const std::string& path, const std::vector<MapChange>& changes) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "kind,again,x,y,size,cells,probability\n";
    for (const MapChange& c : changes) {
      out << toString(c.kind) << ',' << (c.again ? 1 : 0) << ',' << c.center.x << ',' << c.center.y
          << ',' << c.size << ',' << c.cells.size() << ',' << c.probability << '\n';
    }
  });
}

/// x, y, theta: where the newer observation was made, in the frame of the older one; by the scans
/// where they fit, else as words have it: the same place. Verified: the scans fit, and other places
/// beside it say the same.
void writeMatches(const std::string& path, const std::vector<SlamMatch>& matches) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "stamp_a,stamp_b,level,n,direction,x,y,theta,verified,probability,tried,scans_fit\n";
    for (const SlamMatch& m : matches)
      out << std::setprecision(15) << m.stamp_newer << ',' << m.stamp_older << ','
          << std::setprecision(6) << m.level << ',' << m.n << ','
          << (m.direction == Direction::kReverse ? "reverse" : "same") << ',' << m.measured.x << ','
          << m.measured.y << ',' << m.measured.theta << ',' << (m.accepted ? 1 : 0) << ','
          << m.probability << ',' << (m.tried ? 1 : 0) << ',' << (m.verified ? 1 : 0) << '\n';
  });
}

void writeSemanticRegions(const std::string& path, const SlamEngine& engine) {
  std::vector<SemanticRegion> regions;
  for (const RegionNode& n : regionGraph(engine).nodes) {
    SemanticRegion r;
    r.first = n.first;
    r.last = n.last;
    r.semantic_class = n.semantic_class;
    r.confidence = n.confidence;
    regions.push_back(r);
  }
  const ObservationStore& observations = engine.recognizer().observations();
  std::vector<double> stamps;
  for (std::uint32_t i = 0; i < observations.size(); ++i) stamps.push_back(observations.stamp(i));
  writeRegions(path, regions, stamps);
}

nlohmann::json toJson(const SlamCounters::Loops& l) {
  return {{"tried", l.tried}, {"verified", l.verified}, {"accepted", l.accepted}};
}

struct FalseLoops {
  std::size_t near = 0, far = 0, words = 0, signatures = 0, matches = 0;
};

FalseLoops falseLoops(const SlamEngine& engine,
                      const std::vector<hyselam::StampedPose2>& reference) {
  const auto isFalse = [&](int older, int newer, const Pose2& measured) {
    const auto error =
        loopError(engine.keyframes()[static_cast<std::size_t>(older)],
                  engine.keyframes()[static_cast<std::size_t>(newer)], measured, reference);
    return error && error->isFalse();
  };
  FalseLoops count;
  for (const SlamLoop& l : engine.loops()) {
    if (!isFalse(l.older, l.newer, l.measured)) continue;
    ++(l.source == LoopSource::kNgram       ? count.words
       : l.source == LoopSource::kSignature ? count.signatures
       : l.far                              ? count.far
                                            : count.near);
  }
  for (const SlamMatch& m : engine.matches()) {
    if (m.accepted && isFalse(m.keyframe_older, m.keyframe_newer, m.measured)) ++count.matches;
  }
  return count;
}

nlohmann::json errorOf(const Run& run, const std::vector<hyselam::StampedPose2>& reference) {
  const SlamEngine& engine = *run.engine;
  const TrajectoryError e = trajectoryError(ownTrajectory(engine, run.saved_scans), reference);
  const FalseLoops false_loops = falseLoops(engine, reference);
  const auto without_weight = std::count_if(engine.loops().begin(), engine.loops().end(),
                                            [](const SlamLoop& l) { return !isUsed(l); });
  return {{"poses", e.poses},
          {"mean_m", e.mean},
          {"rms_m", e.rms},
          {"largest_m", e.max},
          {"mean_deg", hyselam::degrees(e.mean_angle)},
          {"mean_of_1_m_m", e.mean_step},
          {"mean_of_1_m_deg", hyselam::degrees(e.mean_step_angle)},
          {"false_loops_near", false_loops.near},
          {"false_loops_far", false_loops.far},
          {"false_loops_by_words", false_loops.words},
          {"false_loops_by_signatures", false_loops.signatures},
          {"false_verified_matches", false_loops.matches},
          {"loops_without_weight", without_weight}};
}

nlohmann::json summaryOf(const Run& run, double log_seconds) {
  const SlamEngine& e = *run.engine;
  const SlamCounters& c = e.counters();
  const auto& keyframes = e.keyframes();
  nlohmann::json j = {{"scans", c.scans},
                      {"scans_without_odometry", run.without_odometry},
                      {"scans_refused", run.refused},
                      {"keyframes", keyframes.size()},
                      {"way_m", keyframes.empty() ? 0.0 : keyframes.back().path_length},
                      {"observations", e.recognizer().observations().size()},
                      {"words", e.recognizer().text().words()},
                      {"matches", e.matches().size()},
                      {"loops", e.loops().size()},
                      {"loops_near", toJson(c.near)},
                      {"loops_far", toJson(c.far)},
                      {"loops_by_words", toJson(c.words)},
                      {"loops_by_signatures", toJson(c.signatures)},
                      {"optimizations", c.optimizations},
                      {"scans_searched", c.relocalized},
                      {"scans_weak", c.weak_matches},
                      {"odometry_leaps", c.odometry_jumps},
                      {"log_seconds", log_seconds},
                      {"cpu_seconds", run.cpu},
                      {"times_real_time", run.cpu > 0.0 ? log_seconds / run.cpu : 0.0},
                      {"peak_memory_mb", peakMegabytes()}};
  const LoopCounts places(e.loops(), run.saved_keyframes);
  j["places_seen_again"] = sentenceOf(places);
  j["loops_by_kind"] = toJson(places);
  j["place"] = toString(e.runPlace());
  const auto tied = e.pathUntilTied();
  j["tied_after_m"] = tied ? nlohmann::json(*tied) : nlohmann::json();
  j["ties_withdrawn"] = e.tiesWithdrawn();
  const RoughRoad& road = e.roughRoad();
  j["rough_road"] = {{"scans_moved_unseen", road.scans_moved_unseen},
                     {"path_unseen_m", road.path_unseen},
                     {"turn_unseen_deg", hyselam::degrees(road.turn_unseen)},
                     {"odometry_overruled", road.odometry_overruled},
                     {"steps_checked", road.steps_checked},
                     {"steps_mended", road.steps_mended},
                     {"wide_searches", road.wide_searches},
                     {"gaps", road.gaps},
                     {"lost", road.lost},
                     {"runs_split", road.runs_split}};
  return j;
}

/// By the keyframes of the recording itself.
std::optional<LaserMount> mountOf(const Run& run) {
  const auto& all = run.engine->keyframes();
  return estimateLaserMount(
      {all.begin() + static_cast<std::ptrdiff_t>(run.saved_keyframes), all.end()});
}

nlohmann::json toJson(const std::optional<LaserMount>& mount, bool corrected) {
  if (!mount) return {{"told", "the recording turns too little, or its scans do not overlap"}};
  const auto pose = [](const Pose2& p) {
    return nlohmann::json{{"x_m", p.x}, {"y_m", p.y}, {"deg", hyselam::degrees(p.theta)}};
  };
  return {{"told", mount->text()},
          {"as_told", pose(mount->told)},
          {"estimated", pose(mount->estimated)},
          {"standard_deviation", pose({mount->stddev[0], mount->stddev[1], mount->stddev[2]})},
          {"pairs", mount->pairs},
          {"wrong", mount->wrong()},
          {"corrected", corrected},
          {"odometry_tells_of_distance", mount->distance_scale},
          {"odometry_tells_of_rotation", mount->rotation_scale}};
}

/// What makes the map doubtful, in sentences; none for a run that went well.
nlohmann::json troubleOf(const Run& run, const std::optional<LaserMount>& mount, bool corrected) {
  const RoughRoad& road = run.engine->roughRoad();
  nlohmann::json sentences = nlohmann::json::array();
  const auto tell = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) sentences.push_back(std::to_string(count) + " " + what);
  };
  if (odometryStands(road, run.engine->keyframes(), run.saved_keyframes)) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(1) << "the scans show " << road.path_unseen << " m and "
         << std::setprecision(0) << hyselam::degrees(road.turn_unseen)
         << " deg of motion while the odometry stands still";
    sentences.push_back(text.str());
  }
  // Recordings of key scans only have nothing else.
  const std::uint64_t scans = run.engine->counters().scans - run.saved_counts;
  if (static_cast<double>(road.gaps) < kGapsOfScans * static_cast<double>(scans)) {
    tell(road.gaps, "gaps without scans");
  }
  tell(road.lost, "times neither odometry nor scans told how the robot moved");
  tell(road.runs_split, "times the run was split there; loops join its pieces again");
  if (run.engine->runPlace() == RunPlace::kSupposed ||
      run.engine->runPlace() == RunPlace::kOwnMap) {
    sentences.push_back("the last piece of the run is not joined to the rest of the map");
  }
  if (mount && mount->wrong() && !corrected) sentences.push_back(mount->text());
  return sentences;
}

/// Saves the map for the next run, and tells how large it is.
nlohmann::json saveMapState(const std::string& path, const SlamEngine& engine) {
  const double begin = cpuSeconds();
  const SlamState state = consolidated(engine.state(), engine.params().consolidation);
  SlamStateFile::save(path, state);
  return {{"keyframes", state.keyframes.size()},
          {"loops", state.loops.size()},
          {"scans", state.scans.size()},
          {"observations", state.corpus.observations.size()},
          {"bytes", std::filesystem::file_size(path)},
          {"cpu_seconds", cpuSeconds() - begin}};
}

SlamParams paramsOf(const Options& o, LoopClosureMode loops) {
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

/// @throws hyselam::InputError if there is no map in it.
void checkMapped(const Run& run, const std::string& name, std::size_t scans) {
  if (!run.engine->keyframes().empty()) return;
  throw hyselam::InputError(name, "",
                            "gives no map: of " + std::to_string(scans) + " scans " +
                                std::to_string(run.without_odometry) + " have no odometry, " +
                                std::to_string(run.refused) + " cannot be used");
}

void writeResults(const Options& o, const Run& run, const PresentMap& map,
                  const hyselam::RobotLog& log) {
  const SlamEngine& engine = *run.engine;
  hyselam::writeTum(o.out + "/trajectory.tum", ownTrajectory(engine, run.saved_scans));
  if (!o.state.empty()) hyselam::writeTum(o.out + "/trajectory_map.tum", engine.trajectory());
  hyselam::writeTum(o.out + "/odometry.tum", log.odometry);
  hyselam_pose_graph::writeG2o(o.out + "/graph.g2o", engine.graph());
  hyselam::saveMap(o.out + "/map.yaml", map.grid());
  hyselam::saveMap(o.out + "/certainty.yaml", map.probabilities());
  if (!o.state.empty()) writeChanges(o.out + "/changes.csv", map.changes());
  writeWords(o.out + "/words.csv", engine.recognizer());
  writeSemanticRegions(o.out + "/regions.csv", engine);
  writeMatches(o.out + "/matches.csv", engine.matches());
  writeLoops(o.out + "/loops.csv", engine, run.saved_keyframes);
}

void writeJson(const std::string& path, const nlohmann::json& json, int indent) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << json.dump(indent) << "\n"; });
}

nlohmann::json run(const Options& o) {
  const SlamParams params = paramsOf(o, loopClosureModeFromString(o.loops));
  if (!(o.noise >= 0.0)) throw hyselam::ParameterError("odometry-noise", o.noise, "at least 0");
  if (!o.start.empty() && o.state.empty())
    throw hyselam::InputError("--start", o.start, "is a place in a saved map: give --state too");
  if (!o.start.empty() && o.start != "unknown") parseStart(o.start);
  const PresentMap map_check(mapParamsOf(o), {});  // refused before the work, not after it
  std::vector<hyselam::CarmenIssue> issues;
  hyselam::RobotLog log = readLog(o, &issues);
  const std::string name = o.bag.empty() ? o.carmen : o.bag;
  degrade(o.degradation, &log);
  if (o.noise > 0.0) addOdometryNoise(o.noise, o.seed, &log.odometry);
  const std::vector<hyselam::StampedPose2> reference = referenceOf(o.reference, log);
  hyselam::makeFolder(o.out);
  const nlohmann::json log_issues = hyselam::reportIssues(name, issues);

  Run main_run = runSlam(log, makeEngine(o, params), "SLAM of " + name);
  checkMapped(main_run, name, log.scans.size());
  const auto mount = mountOf(main_run);
  const bool corrected = o.correct_laser && mount && mount->wrong();
  if (corrected) {
    for (hyselam::LaserScan& scan : log.scans) scan.laser_in_base = mount->estimated;
    main_run = runSlam(log, makeEngine(o, params), "again, with the laser where it is");
  }
  const SlamEngine& engine = *main_run.engine;
  const auto span = hyselam::timeSpan(log);
  nlohmann::json summary = summaryOf(main_run, span ? span->end - span->begin : 0.0);
  summary["loops_mode"] = o.loops;
  summary["laser_mount"] = toJson(mount, corrected);
  summary["trouble"] = troubleOf(main_run, mount, corrected);
  if (!issues.empty()) {
    summary["trouble"].push_back(troubleOf(issues));
    summary["log_issues"] = log_issues;
  }
  if (!reference.empty()) summary["errors"] = errorOf(main_run, reference);
  const PresentMap present = mapOf(engine, o);
  const std::vector<MapChange> changes = present.changes();
  if (!o.state.empty()) summary["changes"] = summaryOf(changes, engine.knowsChanges());
  writeResults(o, main_run, present, log);
  if (!o.save_state.empty()) summary["saved"] = saveMapState(o.save_state, engine);

  nlohmann::json figures = {
      figureJson("loops: " + o.loops, "map.yaml", engine, main_run.saved_keyframes)};
  figures[0]["changes"] = toJson(changes, o.resolution);
  for (const LoopClosureMode other : {LoopClosureMode::kNone, LoopClosureMode::kThesis}) {
    if (!o.side_by_side || other == params.loops) continue;
    const std::string mode = toString(other), label = "loops: " + mode, map = "map_" + mode;
    const Run r = runSlam(log, std::make_unique<SlamEngine>(paramsOf(o, other)), label);
    nlohmann::json s = {
        {"loops", r.engine->loops().size()},
        {"places_seen_again", sentenceOf(LoopCounts(r.engine->loops(), r.saved_keyframes))},
        {"cpu_seconds", r.cpu}};
    if (!reference.empty()) s.update(errorOf(r, reference));
    summary["side_by_side_" + mode] = s;
    hyselam::writeTum(o.out + "/trajectory_" + mode + ".tum", r.engine->trajectory());
    hyselam::saveMap(o.out + "/" + map + ".yaml", mapOf(*r.engine, o).grid());
    figures.push_back(figureJson(label, map + ".yaml", *r.engine, r.saved_keyframes));
  }
  writeJson(o.out + "/report.json",
            reportJson(std::filesystem::path(name).filename().string(), engine, figures), -1);
  writeJson(o.out + "/summary.json", summary, 2);
  makePage("slam_report", o.out);
  std::cout << summary.dump(2) << "\n";
  return summary;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Map, trajectory, words and recognized places of a recorded run.", "slam_offline");
  Options o;
  app.option_defaults()->always_capture_default();
  auto* bag = app.add_option("--bag", o.bag, "bag with scans and odometry");
  auto* carmen = app.add_option("--carmen", o.carmen, "CARMEN log, plain or gzip");
  bag->excludes(carmen);
  app.add_option("--out", o.out, "folder for what is written")->required();
  app.add_option(
      "--parameters", o.parameters,
      "YAML file with parameters of the node, as in config/slam.yaml; options given here "
      "win over it");
  hyselam::addBagOptions(app, &o.bag_options);
  app.add_option("--levels", o.levels, "levels of words");
  app.add_option("--seed", o.seed, "of the errors of --odometry-noise");
  app.add_option(
      "--loops", o.loops,
      "none, proximity, ngrams (far places by words only), signatures (far places by their "
      "signatures only), all, or thesis (words accepted without verification)");
  app.add_option("--loop-latency", o.loop_latency,
                 "loops and optimizations count at the first scan taken this long after the one at "
                 "which they were begun [s], as in the nodelet; 0: before the next scan");
  app.add_option(
      "--reference", o.reference,
      "poses to compare with: TUM, a table with one pose for each scan, or a corrected log");
  app.add_option("--resolution", o.resolution, "of the map [m]");
  app.add_option("--odometry-noise", o.noise,
                 "add errors to the odometry: this many per cent of distance and rotation, and as "
                 "many centiradians a meter");
  addDegradationOptions(app, &o.degradation);
  app.add_flag("--correct-laser", o.correct_laser,
               "where the recording shows that the laser is mounted elsewhere than told, map it "
               "again with the laser there");
  app.add_option("--state", o.state,
                 "a saved map to go on with; trajectory.tum has the poses of this recording, "
                 "trajectory_map.tum those of all");
  app.add_option("--start", o.start,
                 "where the robot stands in the saved map, X,Y,THETA [m, rad], or unknown; without "
                 "it, where the last run ended");
  app.add_option("--save-state", o.save_state, "file for the map, to go on with later");
  app.add_flag("--keep-all", o.keep_all,
               "keep all keyframes of the maps that are loaded and saved, whether they add to "
               "them or not");
  app.add_flag("--raw-odometry", o.raw_odometry, "do not refine the odometry by scans");
  app.add_flag("--side-by-side", o.side_by_side,
               "the same without loops and in thesis mode too, for the report");
  return hyselam::runTool(argc, argv, app, [&] {
    o.loops_given = app.count("--loops") > 0;
    loadParameters(app, &o);
    return run(o);
  });
}

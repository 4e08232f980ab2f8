// slam_offline: a recorded run through the same SLAM as the nodelet, without a master.
#include <filesystem>
#include <iostream>
#include <utility>

#include "degrade.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/report_issues.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"
#include "loop_table.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "reference_poses.hpp"
#include "report_page.hpp"
#include "slam_offline_options.hpp"
#include "slam_report.hpp"
#include "slam_run.hpp"
#include "slam_summary.hpp"
#include "slam_tables.hpp"
#include "tool_parts.hpp"
#include "word_tables.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using Options = SlamOfflineOptions;

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

/// What SLAM gets, and what is known of it.
struct Recording {
  std::string name;
  hyselam::RobotLog log;  ///< made worse if the options say so
  std::vector<hyselam::StampedPose2> reference;
  std::vector<hyselam::CarmenIssue> issues;
  nlohmann::json log_issues;
};

Recording prepare(const Options& o) {
  Recording r;
  r.name = o.bag.empty() ? o.carmen : o.bag;
  r.log = readLog(o, &r.issues);
  degrade(o.degradation, &r.log);
  if (o.noise > 0.0) addOdometryNoise(o.noise, o.seed, &r.log.odometry);
  r.reference = referenceOf(o.reference, r.log);
  hyselam::makeFolder(o.out);
  r.log_issues = hyselam::reportIssues(r.name, r.issues);
  return r;
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

void writeResults(const Options& o, const SlamRun& run, const PresentMap& map,
                  const hyselam::RobotLog& log) {
  const SlamEngine& engine = *run.engine;
  hyselam::writeTum(o.out + "/trajectory.tum", ownTrajectory(run));
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

/// The recording once more, from its start without the saved map, with another mode of loops: its
/// trajectory and map as files, its figure for the page.
/// @returns what the summary says of it
nlohmann::json runBeside(const Options& o, const Recording& recording, LoopClosureMode loops,
                         nlohmann::json* figures) {
  const std::string mode = toString(loops), label = "loops: " + mode, map = "map_" + mode;
  const SlamRun run =
      runSlam(recording.log, std::make_unique<SlamEngine>(slamParamsOf(o, loops)), label);
  const SlamEngine& engine = *run.engine;
  nlohmann::json told = {
      {"loops", engine.loops().size()},
      {"places_seen_again", sentenceOf(LoopCounts(engine.loops(), run.saved_keyframes))},
      {"cpu_seconds", run.cpu}};
  if (!recording.reference.empty()) told.update(errorOf(run, recording.reference));
  hyselam::writeTum(o.out + "/trajectory_" + mode + ".tum", engine.trajectory());
  hyselam::saveMap(o.out + "/" + map + ".yaml", mapOf(engine, o).grid());
  figures->push_back(figureJson(label, map + ".yaml", engine, run.saved_keyframes));
  return told;
}

nlohmann::json run(const Options& o) {
  checkOptions(o);
  const SlamParams params = slamParamsOf(o, loopClosureModeFromString(o.loops));
  Recording recording = prepare(o);
  SlamRun main_run = runSlam(recording.log, makeEngine(o, params), "SLAM of " + recording.name);
  checkMapped(main_run, recording.name, recording.log.scans.size());
  const auto mount = mountOf(main_run);
  const bool corrected = o.correct_laser && mount && mount->wrong();
  if (corrected) {
    for (hyselam::LaserScan& scan : recording.log.scans) scan.laser_in_base = mount->estimated;
    main_run = runSlam(recording.log, makeEngine(o, params), "again, with the laser where it is");
  }
  const SlamEngine& engine = *main_run.engine;
  const auto span = hyselam::timeSpan(recording.log);
  nlohmann::json summary = summaryOf(main_run, span ? span->end - span->begin : 0.0);
  summary["loops_mode"] = o.loops;
  summary["laser_mount"] = toJson(mount, corrected);
  summary["trouble"] = troubleOf(main_run, mount, corrected);
  if (!recording.issues.empty()) {
    summary["trouble"].push_back(troubleOf(recording.issues));
    summary["log_issues"] = recording.log_issues;
  }
  if (!recording.reference.empty()) summary["errors"] = errorOf(main_run, recording.reference);
  const PresentMap present = mapOf(engine, o);
  const std::vector<MapChange> changes = present.changes();
  if (!o.state.empty()) summary["changes"] = summaryOf(changes, engine.knowsChanges());
  writeResults(o, main_run, present, recording.log);
  if (!o.save_state.empty()) summary["saved"] = saveMapState(o.save_state, engine);

  nlohmann::json figures = {
      figureJson("loops: " + o.loops, "map.yaml", engine, main_run.saved_keyframes)};
  figures[0]["changes"] = toJson(changes, o.resolution);
  for (const LoopClosureMode other : {LoopClosureMode::kNone, LoopClosureMode::kThesis}) {
    if (!o.side_by_side || other == params.loops) continue;
    summary[std::string("side_by_side_") + toString(other)] =
        runBeside(o, recording, other, &figures);
  }
  const std::string file_name = std::filesystem::path(recording.name).filename().string();
  writeJson(o.out + "/report.json", reportJson(file_name, engine, figures), -1);
  writeJson(o.out + "/summary.json", summary, 2);
  makePage("slam_report", o.out);
  std::cout << summary.dump(2) << "\n";
  return summary;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Map, trajectory, words and recognized places of a recorded run.", "slam_offline");
  SlamOfflineOptions o;
  addOptions(app, &o);
  return hyselam::runTool(argc, argv, app, [&] {
    loadParameters(app, &o);
    return run(o);
  });
}

#include "slam_summary.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <iomanip>
#include <sstream>

#include "loop_table.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "ngram_slam/slam/standing_odometry.hpp"

namespace ngram_slam {

namespace {

constexpr double kGapsOfScans = 0.2;  // more of them are no gaps

double peakMegabytes() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) / 1024.0;
}

nlohmann::json toJson(const SlamCounters::Loops& l) {
  return {{"tried", l.tried}, {"verified", l.verified}, {"accepted", l.accepted}};
}

struct FalseLoops {
  std::size_t near = 0, far = 0, words = 0, signatures = 0, matches = 0;
};

FalseLoops falseLoops(const SlamEngine& engine,
                      const std::vector<hyselam::StampedPose2>& reference) {
  const auto isFalse = [&](int older, int newer, const hyselam::Pose2& measured) {
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

}  // namespace

nlohmann::json errorOf(const SlamRun& run, const std::vector<hyselam::StampedPose2>& reference) {
  const SlamEngine& engine = *run.engine;
  const TrajectoryError e = trajectoryError(ownTrajectory(run), reference);
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

nlohmann::json summaryOf(const SlamRun& run, double log_seconds) {
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

nlohmann::json toJson(const std::optional<LaserMount>& mount, bool corrected) {
  if (!mount) return {{"told", "the recording turns too little, or its scans do not overlap"}};
  const auto pose = [](const hyselam::Pose2& p) {
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

nlohmann::json troubleOf(const SlamRun& run, const std::optional<LaserMount>& mount,
                         bool corrected) {
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

}  // namespace ngram_slam
